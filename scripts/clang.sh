#!/usr/bin/env bash
# Builds the program by clang, warnings as errors, and runs it.
set -euo pipefail
cd "$(dirname "$0")/.."

# std::stable_sort of libstdc++ 12 calls std::get_temporary_buffer, which its own header deprecates.
build=$PWD/build/clang
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++-19 \
  -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG -Wno-deprecated-declarations" -DMINDAHL_WARNINGS_AS_ERRORS=ON \
  -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_UNITY_BUILD_BATCH_SIZE=12 >/dev/null
cmake --build "$build" --target mindahl
"$build/src/mindahl" validate --cases 5
