#!/bin/sh
# preprocess.sh COMPILER ARGUMENT...: in the place of a compiler, finds every header that a source includes and makes an
# empty object.
set -eu
case "$*" in
  *CMakeScratch* | *cmTC_* | *CMakeTmp*) ;;
  *" -c "*) "$@" -E ;;  # into the object file, for a moment
esac
exec sh "$(dirname "$0")/empty_object.sh" "$@"
