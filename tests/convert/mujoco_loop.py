#!/usr/bin/env python3
"""Runs MuJoCo with what `mindahl convert --to mujoco, mujoco-joint and urdf` writes.

    mujoco_loop.py --program build/dev/src/mindahl [--mujoco DIRECTORY]

A joint is moved to and fro. Of the last cycle the script takes what mindahl states of its
conversion: the largest difference of force from Mindlin's loop over T*, and the energy lost over
that of Mindlin's loop; then the creep of `frictionloss`, the damping, and what the engine reads of
URDF. Exit status 77, for ctest a skipped test, where node or the package is absent.
"""

import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree

from mindlin_contact import AMPLITUDE, PEAK_FORCE, SIGMA, SLIP_FORCE, converted, loop_error

SKIPPED = 77
STEPS = 4000   # a cycle of 1 s
CYCLES = 14    # Dahl's law forgets where it began by exp(-4X/h) a cycle: 1e-8 of it is left
MASS = 2.0     # [kg], of the joint that creeps
TIME_STEP = 0.002
VISCOUS = 3.0  # [N s/m]

MODEL = """<mujoco><option timestep="{step}" gravity="0 0 0"/>
<worldbody><body>{joint}<geom size="0.01" mass="{mass}"/></body></worldbody>{motor}</mujoco>"""
URDF = """<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/>{dynamics}</joint></robot>"""

# The motion is imposed: position and velocity are set before each step, the state is the engine's.
SCRIPT = """
import {{ pathToFileURL }} from 'node:url';
const load = (await import(pathToFileURL({module}))).default;
const mujoco = await load();
const models = {models};
const open = (text) => {{
  const model = mujoco.MjModel.from_xml_string(text);
  return [model, new mujoco.MjData(model)];
}};
const place = (i) => {amplitude} * Math.sin(2 * Math.PI * i / {steps});
const result = {{version: mujoco.mj_versionString(), loops: []}};
for (const text of models.loops) {{
  const [model, data] = open(text);
  const rows = [];
  for (let i = 0; i <= {cycles} * {steps}; ++i) {{
    data.qpos[0] = place(i);
    data.qvel[0] = (place(i) - place(i - 1)) * {steps};
    mujoco.mj_forward(model, data);
    if (i >= ({cycles} - 1) * {steps}) {{
      rows.push([place(i), -data.qfrc_actuator[0] - data.qfrc_constraint[0]]);
    }}
    data.qvel[0] = (place(i + 1) - place(i)) * {steps};
    mujoco.mj_step(model, data);
  }}
  result.loops.push(rows);
}}
{{
  const [model, data] = open(models.creeping);
  for (let i = 0; i < 500; ++i) {{
    data.qfrc_applied[0] = models.held;
    mujoco.mj_step(model, data);
  }}
  result.creep = data.qvel[0];
}}
result.damping = models.damped.map((text) => {{
  const [model, data] = open(text);
  data.qvel[0] = 1;
  mujoco.mj_forward(model, data);
  return -data.qfrc_actuator[0] - data.qfrc_passive[0];
}});
const [robot] = open(models.urdf);
result.urdf = [robot.dof_frictionloss[0], robot.dof_damping[0]];
console.log(JSON.stringify(result));
"""

STEEPEST = SIGMA * AMPLITUDE / PEAK_FORCE  # of either loop, in T* a displacement of X
# Force is exact at every step; the loops may differ most between two of them, and the energy is
# a sum of trapezia, the corners of which are off by a step each.
STEP_ERROR = STEEPEST * math.pi / STEPS


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", required=True, help="mindahl")
    parser.add_argument("--mujoco", help="folder of the package @mujoco/mujoco; default: npm's global one")
    arguments = parser.parse_args()
    if shutil.which("node") is None:
        print("skipped: there is no node; install-dependencies.sh --peers has it")
        return SKIPPED
    folder = arguments.mujoco
    if folder is None and shutil.which("npm"):
        root = subprocess.run(["npm", "root", "-g"], check=True, capture_output=True, text=True).stdout
        folder = pathlib.Path(root.strip(), "@mujoco", "mujoco")
    if folder is None or not pathlib.Path(folder, "mujoco.js").exists():
        print("skipped: there is no @mujoco/mujoco; install-dependencies.sh --peers has it")
        return SKIPPED

    def model(joint, motor="", step=1 / STEPS, mass=1e9):  # so heavy that friction does not move it
        actuator = f"<actuator>{motor}</actuator>" if motor else ""
        return MODEL.format(step=step, joint=joint, motor=actuator, mass=mass)

    slide = '<joint name="joint" type="slide"/>'
    (motor,), of_motor = converted(arguments.program, "mujoco")
    (joint,), of_joint = converted(arguments.program, "mujoco-joint")
    viscous = ("--viscous", repr(VISCOUS))
    (damped_motor,), _ = converted(arguments.program, "mujoco", *viscous)
    (damped_joint,), _ = converted(arguments.program, "mujoco-joint", *viscous)
    (urdf,), of_urdf = converted(arguments.program, "urdf", *viscous)
    (sdf,), of_sdf = converted(arguments.program, "sdf", *viscous)
    friction = of_joint["parameters"]["frictionloss"]["value"]
    models = {"loops": [model(slide, motor), model(joint)],
              "creeping": model(joint, step=TIME_STEP, mass=MASS), "held": friction / 2,
              "damped": [model(slide, damped_motor), model(damped_joint)],
              "urdf": URDF.format(dynamics=urdf)}
    script = SCRIPT.format(module=json.dumps(str(pathlib.Path(folder, "mujoco.js").resolve())),
                           models=json.dumps(models), amplitude=repr(AMPLITUDE), steps=STEPS,
                           cycles=CYCLES)
    output = subprocess.run(["node", "--input-type=module", "-"], input=script, capture_output=True,
                            text=True, check=False)
    if output.returncode != 0:
        sys.exit(f"MuJoCo failed on:\n{json.dumps(models, indent=1)}\n{output.stderr}")
    result = json.loads(output.stdout)

    print(f"MuJoCo {result['version']}, Tc {SLIP_FORCE:g} N, X {AMPLITUDE:.6g} m\n")
    print(f"{'line':<16} {'force':>8} {'stated':>8} {'energy':>9} {'stated':>9}")
    failures = []
    for name, rows, report in (("dcmotor lugre", result["loops"][0], of_motor),
                               ("frictionloss", result["loops"][1], of_joint)):
        worst, energy = loop_error([x for x, _ in rows], [force for _, force in rows])
        stated = report["error_at_amplitude"]
        print(f"{name:<16} {100 * worst:8.3f} {100 * stated['force']:8.3f} {100 * energy:9.3f} "
              f"{100 * stated['energy']:9.3f}")
        if (abs(worst - stated["force"]) > 2 * STEP_ERROR or
                abs(energy - stated["energy"]) > 10 * STEP_ERROR):
            failures.append(name)
    expected = of_joint["parameters"]["creep"]["value"] * friction / 2 * TIME_STEP / MASS
    print(f"\nin per cent of T* and of the energy\ncreep under half of frictionloss "
          f"{result['creep']:.6g} m/s, stated {expected:.6g} m/s")
    # The engine's solver ends at a gradient of 1e-8 over the force.
    if abs(result["creep"] / expected - 1) > 1e-6:
        failures.append("creep")
    if any(abs(value - VISCOUS) > 1e-6 for value in result["damping"]):
        failures.append(f"damping {result['damping']}")
    read = [of_urdf["parameters"][name]["value"] for name in ("friction", "damping")]
    if result["urdf"] != read:
        failures.append(f"urdf {result['urdf']}")
    tree = xml.etree.ElementTree.fromstring(sdf)
    if ([float(tree.findtext(name)) for name in ("friction", "damping")] !=
            [of_sdf["parameters"][name]["value"] for name in ("friction", "damping")]):
        failures.append("sdf")
    if failures:
        print(f"what MuJoCo does is not what is stated: {', '.join(failures)}", file=sys.stderr)
    return int(bool(failures))


if __name__ == "__main__":
    sys.exit(main())
