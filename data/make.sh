#!/bin/sh
# Makes the loops of data/ that a measurement would give: what mindahl simulates, put into a rig, a
# logger or a file of another laboratory.
#   data/make.sh PROGRAM FOLDER
set -eu
mindahl=$1
folder=$2

contact="--model mindlin --normal-load 50 --friction 0.3
  --youngs-modulus-1 210e9 --poisson-1 0.3 --radius-1 0.05
  --youngs-modulus-2 210e9 --poisson-2 0.3 --radius-2 inf"

# shellcheck disable=SC2086  # the contact is several words
loop() { "$mindahl" simulate $contact --samples-per-cycle 200 --noise-force 0.075 "$@"; }

# The first cycle and a fifth of the second are left out.
loop --lambda 1.2 --cycles 4 --seed 31 | awk 'NR == 1 || NR > 242' >"$folder/steady.csv"

# A load cell on the other body.
loop --lambda 1.2 --cycles 3 --seed 12 | awk -F, -v OFS=, '
  NR == 1 { print; next }
  { print $1, $2, ($3 ~ /^-/ ? substr($3, 2) : "-" $3) }' >"$folder/opposite_sign.csv"

# The displacement is that of the drive: a rig of 1e8 N/m gives way between it and the contact.
loop --lambda 1.2 --cycles 3 --seed 13 | awk -F, -v OFS=, '
  NR == 1 { print; next }
  { print $1, sprintf("%.9e", $2 + $3 / 1e8), $3 }' >"$folder/behind_a_rig.csv"

# The force is read three samples of 200, 15 ms, after the displacement.
loop --lambda 1.2 --cycles 3 --seed 14 | awk -F, -v OFS=, '
  NR == 1 { print; next }
  { force[NR] = $3; print $1, $2, (NR > 4 ? force[NR - 3] : force[2]) }' >"$folder/lag.csv"

# As a logger would write it: a preamble, semicolons and decimal commas, micrometres, the force of
# the other body with an offset, the drive's displacement behind a rig of 80 N/um, no virgin branch.
loop --lambda 2 --cycles 6 --seed 15 --noise-displacement 1e-9 --frequency 5 | awk -F, '
  NR == 1 {
    print "Fretting rig 2, run 17"
    print "ball 100Cr6 d = 100 mm on plate, N = 50 N"
    print ""
    print "Time;Actuator;Load cell"
    print "ms;um;N"
    next
  }
  NR > 242 {
    line = sprintf("%.1f;%.4f;%.3f", 1e3 * ($1 - 0.24), 1e6 * $2 + $3 / 80, 1.2 - $3)
    gsub(/[.]/, ",", line)
    print line
  }' >"$folder/raw_rig_record.csv"

motion=$(mktemp)
trap 'rm -f "$motion"' EXIT

# The force is imposed, to 0.9 of the slip force, and exact; the noise is in the displacement, which is that of
# Mindlin's curve, d(T) = 3/2 Tc/s (1 - (1 - T/Tc)^(2/3)), and of Masing's rules.
awk 'function d(t) { return 1.5 * 15 / 48136532.76068716 * (1 - (1 - t / 15) ^ (2 / 3)) }
BEGIN {
  print "displacement [m],force [N]"
  for (i = 0; i <= 600; ++i) {
    t = sprintf("%.9e", 13.5 * sin(6.283185307179586 * (i % 200) / 200)) + 0
    if (i <= 50) x = d(t)
    else x = int((i - 50) / 100) % 2 ? 2 * d((13.5 + t) / 2) - d(13.5) : d(13.5) - 2 * d((13.5 - t) / 2)
    printf "%.17g,%.17g\n", x, t
  }
}' >"$motion"
# shellcheck disable=SC2086
"$mindahl" simulate $contact --path "$motion" --noise-displacement 2e-9 --seed 16 |
  paste -d, - "$motion" | cut -d, -f1,2,5 >"$folder/imposed_force.csv"

# A strain-wave drive of a robot: friction in proportion to the torque that it carries, which changes
# its sign, and different in the two directions; knee 1.2 mrad, 3 N m under the mean of 21.8 N m. The state z of
# Dahl's law, dz = (1 - sgn(dx) z) dx/h, has the torque 3 (|N| z - 0.2 N z^2)/21.7868; a stiffness that is nearly none
# gives the noise.
awk 'BEGIN {
  print "angle [rad],torque [N m]"
  for (i = 0; i <= 600; ++i) {
    phase = 6.283185307179586 * i / 200
    printf "%.9e,%.6f\n", 3.6e-3 * sin(phase), 12 + 28 * cos(0.4 * phase)
  }
}' >"$motion"
"$mindahl" simulate --model jenkins --sigma 1e-9 --slip-force 3 --path "$motion" --noise-force 0.015 --seed 17 |
  paste -d, - "$motion" | awk -F, -v OFS=, '
    NR == 1 { print "time [s]", "angle [rad]", "friction torque [N m]", "torque [N m]"; next }
    {
      way = $4 - x
      x = $4
      to = way < 0 ? -1 : 1
      z = to + (z - to) * exp(-to * way / 1.2e-3)
      load = $5 < 0 ? -$5 : $5
      print 0.01 * $1, sprintf("%.9e", $2), sprintf("%.6f", 3 * (load * z - 0.2 * $5 * z * z) / 21.7868 + $3),
        sprintf("%.6f", $5)
    }' >"$folder/joint.csv"
