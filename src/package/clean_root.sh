#!/bin/sh
# clean_root.sh ROOT PACKAGES SOURCES: installs the packages into a Debian with nothing else (made by debootstrap, as
# root) and uses them there as a stranger would: the program, programs by CMake and pkg-config, Python.
set -eu
root=$1 packages=$2 sources=$3
inside() {  # with nothing of the caller's environment
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root \
    http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" "$@"
}
install() { inside apt-get install -y -qq --no-install-recommends "$@" >/dev/null; }

if [ ! -e "$root/usr/bin/apt-get" ]; then
  rm -rf "$root"
  debootstrap --variant=minbase bookworm "$root" >/dev/null
fi
rm -rf "$root/given"
mkdir "$root/given"
cp "$packages"/*.deb "$root/given"
cp -r "$sources/tests/link/consumer" "$root/given"
names=$(cd "$packages" && ls -- *.deb)
given() { for name in $names; do case $name in $1_*) echo "/given/$name" ;; esac; done; }
inside apt-get update -qq

scene=/usr/share/manycontact/models/humanoid_standing.xml
# shellcheck disable=SC2046
install $(given manycontact)
inside manycontact solve $scene

# shellcheck disable=SC2046
install $(given 'libmanycontact*') g++ cmake make pkg-config
for library in manycontact shared; do
  inside cmake -S /given/consumer -B /given/$library -DLIBRARY=$library "-DPROGRAMS=main;action" >/dev/null
  inside cmake --build /given/$library >/dev/null
  inside /given/$library/main $scene
  inside /given/$library/action $scene
done
inside sh -c 'g++ -std=c++20 /given/consumer/main.cpp -o /given/main $(pkg-config --cflags --libs manycontact)'
inside /given/main $scene

python=$(given python3-manycontact)
if [ "$python" ]; then
  install "$python"
  inside python3 -c "
import manycontact as mc
scene = mc.load_scene('$scene')
data = mc.SceneData(scene.scene)
print(mc.solve(scene.scene, scene.q, scene.v, scene.u, data).status)"
fi

# Nothing is left when they are gone.
# shellcheck disable=SC2046
inside apt-get purge -y -qq $(for name in $names; do echo "${name%%_*}"; done) >/dev/null
if inside find /usr -name '*manycontact*' | grep .; then exit 1; fi
echo "packages: installed, used and removed in a clean root"
