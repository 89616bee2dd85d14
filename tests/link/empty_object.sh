#!/bin/sh
# empty_object.sh COMPILER ... -o FILE ...: in the place of a compiler, to see in seconds that a build has all its rules.
# What asks about the compiler itself is compiled.
case "$*" in *CMakeScratch* | *cmTC_* | *CMakeTmp*) exec "$@" ;; esac
compiler=$1
for word; do
  [ "${last:-}" = -MF ] && : >"$word"
  [ "${last:-}" = -o ] && out=$word
  last=$word
done
exec "$compiler" -x c++ -c /dev/null -o "$out"
