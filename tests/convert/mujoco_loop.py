#!/usr/bin/env python3
"""Runs MuJoCo with what `mindahl convert --to mujoco` writes.

    mujoco_loop.py --program build/dev/src/mindahl [--mujoco DIRECTORY]

A joint is moved to and fro. Of the last cycle the script takes what mindahl states of its
conversion: the largest difference of force from Mindlin's loop over T*, and the energy lost over
that of Mindlin's loop; then the damping. Exit status 77, for ctest a skipped test, where node or
the package is absent.
"""

import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys

from mindlin_contact import AMPLITUDE, PEAK_FORCE, SIGMA, SLIP_FORCE, converted, loop_error

SKIPPED = 77
STEPS = 4000   # a cycle of 1 s
CYCLES = 14    # Dahl's law forgets where it began by exp(-4X/h) a cycle: 1e-8 of it is left
VISCOUS = 3.0  # [N s/m]

MODEL = """<mujoco><option timestep="{step}" gravity="0 0 0"/>
<worldbody><body><joint name="joint" type="slide"/><geom size="0.01" mass="1e9"/></body></worldbody>
<actuator>{motor}</actuator></mujoco>"""  # so heavy that friction does not move it

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
const result = {{version: mujoco.mj_versionString(), loop: []}};
{{
  const [model, data] = open(models.motor);
  for (let i = 0; i <= {cycles} * {steps}; ++i) {{
    data.qpos[0] = place(i);
    data.qvel[0] = (place(i) - place(i - 1)) * {steps};
    mujoco.mj_forward(model, data);
    if (i >= ({cycles} - 1) * {steps}) {{
      result.loop.push([place(i), -data.qfrc_actuator[0]]);
    }}
    data.qvel[0] = (place(i + 1) - place(i)) * {steps};
    mujoco.mj_step(model, data);
  }}
}}
const [model, data] = open(models.damped);
data.qvel[0] = 1;
mujoco.mj_forward(model, data);
result.damping = -data.qfrc_actuator[0] - data.qfrc_passive[0];
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

    (motor,), report = converted(arguments.program, "mujoco")
    (damped,), _ = converted(arguments.program, "mujoco", "--viscous", repr(VISCOUS))
    models = {name: MODEL.format(step=1 / STEPS, motor=line)
              for name, line in (("motor", motor), ("damped", damped))}
    script = SCRIPT.format(module=json.dumps(str(pathlib.Path(folder, "mujoco.js").resolve())),
                           models=json.dumps(models), amplitude=repr(AMPLITUDE), steps=STEPS,
                           cycles=CYCLES)
    output = subprocess.run(["node", "--input-type=module", "-"], input=script, capture_output=True,
                            text=True, check=False)
    if output.returncode != 0:
        sys.exit(f"MuJoCo failed on:\n{json.dumps(models, indent=1)}\n{output.stderr}")
    result = json.loads(output.stdout)

    print(f"MuJoCo {result['version']}, Tc {SLIP_FORCE:g} N, X {AMPLITUDE:.6g} m\n")
    worst, energy = loop_error(*zip(*result["loop"]))
    stated = report["error_at_amplitude"]
    print(f"{'force':>8} {'stated':>8} {'energy':>9} {'stated':>9}\n"
          f"{100 * worst:8.3f} {100 * stated['force']:8.3f} {100 * energy:9.3f} "
          f"{100 * stated['energy']:9.3f}\nin per cent of T* and of the energy")
    failures = []
    if (abs(worst - stated["force"]) > 2 * STEP_ERROR or
            abs(energy - stated["energy"]) > 10 * STEP_ERROR):
        failures.append("loop")
    if abs(result["damping"] - VISCOUS) > 1e-6:
        failures.append(f"damping {result['damping']}")
    if failures:
        print(f"what MuJoCo does is not what is stated: {', '.join(failures)}", file=sys.stderr)
    return int(bool(failures))


if __name__ == "__main__":
    sys.exit(main())
