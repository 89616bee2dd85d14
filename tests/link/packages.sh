#!/bin/sh
# packages.sh BUILD ROOT SOURCES CXX: makes Debian's packages of a build, unpacks them into ROOT, and uses what is there.
# Their dependencies are this machine's; `./run package --test` installs them into a root of their own.
set -eu
build=$1 root=$2 sources=$3 cxx=$4
rm -rf "$root" "$build/packages"
mkdir -p "$root"
(cd "$build" && cpack -G DEB >/dev/null)
for package in "$build"/packages/*.deb; do
  dpkg-deb -x "$package" "$root"
done

# Their declared dependencies must be here, or our programs could not have been linked.
for package in "$build"/packages/*.deb; do
  dpkg-deb -f "$package" Depends | tr ',' '\n' | sed 's/|.*//; s/(.*//; s/ //g' | while read -r name; do
    case $name in
      "" | libmanycontact*) continue ;;
    esac
    dpkg-query -W -f='${Status}\n' "$name" | grep -q installed || { echo "$name is not installed"; exit 1; }
  done
done

export LD_LIBRARY_PATH="$root/usr/lib"
"$root/usr/bin/manycontact" solve "$root/usr/share/manycontact/models/humanoid_standing.xml"
grep -q '^\.SS optimize' "$root/usr/share/man/man1/manycontact.1"
grep -q 'scenes and tasks to try' "$root/usr/share/man/man1/manycontact.1"

# The shared library exports only our symbols, and programs find it with pkg-config.
nm -DC --defined-only "$root/usr/lib/libmanycontact.so" | grep -v manycontact:: && exit 1
export PKG_CONFIG_PATH="$root/usr/lib/pkgconfig"
for program in main; do
  # shellcheck disable=SC2046
  "$cxx" -std=c++20 "$sources/tests/link/consumer/$program.cpp" -o "$root/$program" \
    $(pkg-config --cflags --libs manycontact)
  "$root/$program" "$root/usr/share/manycontact/models/humanoid_standing.xml"
done
readelf -d "$root/main" | grep -q 'NEEDED.*libmanycontact\.so\.'

# bash completes commands, options and their values.
bash -ec '. "$0/usr/share/bash-completion/completions/manycontact"
  PATH=$0/usr/bin:$PATH
  complete_words() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _manycontact; echo "${COMPREPLY[*]}"; }
  [[ $(complete_words manycontact sol) == solve ]]
  [[ $(complete_words manycontact solve --der) == --derivatives ]]
  [[ $(complete_words manycontact solve --method sparse-l) == sparse-ldl ]]' "$root"
echo "packages: installed and used"
