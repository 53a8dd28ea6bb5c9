#!/usr/bin/env bash
# Installs what building and plotting need, from Debian's packages; quick when all is there.
#   install-dependencies.sh --tests     also what the tests and the Python package need
#   install-dependencies.sh --checks    also what CI checks the source and the pages with
#   install-dependencies.sh --packages  also what makes and tries the Debian packages
#   install-dependencies.sh --peers     also the programs that bench/peers and tests/convert compare with
#   install-dependencies.sh --coverage  also what counts the lines that tests run
#   install-dependencies.sh --fuzz      also the compiler whose libFuzzer runs tests/fuzz
#   install-dependencies.sh --clang     also the other compiler and clang-tidy
#   install-dependencies.sh --readers   also what reads other files and runs the notebooks, in Python
#   install-dependencies.sh --workflow  also what runs campaigns, and a Slurm for them
#   install-dependencies.sh --site      also what makes the pages a site and looks at the licences
set -euo pipefail

packages=(
  g++ cmake ninja-build
  libceres-dev libeigen3-dev libfmt-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev
  zlib1g-dev libboost-dev
  librsvg2-bin jq python3 help2man
)
for group in "$@"; do
  case $group in
    --tests)
      packages+=(
        libgtest-dev libgmock-dev python3-jsonschema pkg-config
        pybind11-dev python3-dev python3-numpy python3-pandas python3-matplotlib
        python3-pytest python3-pip python3-setuptools python3-venv python3-wheel mypy
      )
      ;;
    --checks) packages+=(clang-format doxygen chromium) ;;  # chromium: 290 MB
    --packages) packages+=(dpkg-dev file lintian mmdebstrap pybind11-dev python3-dev python3-numpy) ;;
    --peers)
      packages+=(libbenchmark-dev python3-lmfit python3-scipy python3-pandas lammps gnuplot-nox)
      ;;
    --coverage) packages+=(gcovr) ;;
    --clang) packages+=(clang-19 clang-tidy-19) ;;
    --fuzz) packages+=(clang-19 libclang-rt-19-dev) ;;
    --readers)
      packages+=(
        python3-scipy python3-h5py python3-pint python3-xarray
        python3-nbclient python3-nbformat python3-ipykernel python3-joblib python3-distributed
      )
      ;;
    --workflow) packages+=(snakemake slurmctld slurmd slurm-client munge) ;;
    --site) packages+=(mkdocs reuse) ;;
    *)
      echo "install-dependencies: there is no group '$group': --tests, --checks, --packages, --peers," \
        "--coverage, --fuzz, --clang, --readers, --workflow or --site" >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  if ! dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed; then
    missing+=("$package")
  fi
done
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi

if ! command -v apt-get >/dev/null; then
  echo "install-dependencies: apt-get not found; install by hand: ${missing[*]}" >&2
  exit 1
fi
sudo=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "install-dependencies: not root and no sudo; as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  sudo=(sudo)
fi
echo "installing ${missing[*]}"
"${sudo[@]}" apt-get update -q
"${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -q --no-install-recommends "${missing[@]}"
