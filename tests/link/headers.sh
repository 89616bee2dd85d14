#!/bin/sh
# Compiles every installed header alone, with every warning an error: headers.sh INCLUDE JOBS COMPILER...
set -eu
include=$1 jobs=$2
shift 2
for compiler; do
  find "$include" -name '*.hpp' -printf '%P\0' | xargs -0 -P "$jobs" -I{} sh -c '
    printf "#include \"%s\"\n" "$3" | "$1" -std=c++20 -x c++ -fsyntax-only -I "$2" -isystem /usr/include/eigen3 \
      -isystem /usr/include/suitesparse -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror - ||
      { echo "$1: $3 does not compile alone"; exit 1; }' header "$compiler" "$include" {}
  echo "$compiler: $(find "$include" -name '*.hpp' | wc -l) headers, each compiled alone"
done
