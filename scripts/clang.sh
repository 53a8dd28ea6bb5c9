#!/usr/bin/env bash
# Builds the program by clang, warnings as errors, with each of the two standard libraries as far as it
# goes: with libstdc++ it is linked and run; with libc++ every source is compiled, without code, and
# not linked: Debian's Ceres, glog and fmt have libstdc++'s std::string in their functions.
set -euo pipefail
cd "$(dirname "$0")/.."

# std::stable_sort of libstdc++ 12 calls std::get_temporary_buffer, which its own header deprecates.
build=$PWD/build/clang
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++-19 \
  -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG -Wno-deprecated-declarations" -DMINDAHL_WARNINGS_AS_ERRORS=ON \
  -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_UNITY_BUILD_BATCH_SIZE=12 -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
cmake --build "$build" --target mindahl
"$build/src/mindahl" validate --cases 5

# Unpacked and not installed: with it comes libunwind-19-dev in the place of libunwind-dev, and then
# CMake finds neither glog nor Ceres.
headers=$build/libcxx/usr/lib/llvm-19/include/c++/v1
if [[ ! -d $headers ]]; then
  mkdir -p "$build/libcxx"
  (cd "$build/libcxx" && apt-get download libc++-19-dev libfast-float-dev &&
    for package in *.deb; do dpkg -x "$package" .; done)
fi

# Of each compilation the command, without its output. std::jthread is experimental in this libc++.
jq -r '.[].command' "$build/compile_commands.json" |
  sed -E "s| -o [^ ]+ -c | -fsyntax-only -nostdinc++ -isystem $headers -isystem $build/libcxx/usr/include -fexperimental-library -c |
          s|^ccache ||" |
  xargs -P "$(nproc)" -d '\n' -n 1 bash -c 'echo "${0##* }" && eval "$0" || exit 255'
