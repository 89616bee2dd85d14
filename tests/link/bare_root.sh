#!/bin/sh
# bare_root.sh ROOT SOURCES STEP...: makes a Debian with nothing else (by debootstrap, as root), copies the sources into
# it, and runs the steps there, each with its time: demo, build, test (of ./run), pip (in a fresh virtual environment).
set -eu
root=$1 sources=$2
shift 2
inside() {  # with nothing of the caller's environment
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root \
    http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" "$@"
}

rm -rf "$root"
debootstrap --variant=minbase bookworm "$root" >/dev/null
mount --bind /proc "$root/proc" && trap 'umount "$root/proc"' EXIT
mkdir "$root/src"
git -C "$sources" archive HEAD | tar -x -C "$root/src"
for step; do
  began=$(date +%s)
  case $step in
    pip)
      inside apt-get install -y -qq --no-install-recommends python3-venv python3-dev python3-numpy pybind11-dev >/dev/null
      inside python3 -m venv --system-site-packages /venv
      inside /venv/bin/pip install --quiet /src
      inside /venv/bin/python -c "import manycontact as mc; print(mc.load_scene('/src/models/humanoid_standing.xml').scene.nv)"
      ;;
    *) inside /src/run "$step" ;;
  esac
  echo "bare root: $step took $(($(date +%s) - began)) s, packages included"
done
