#!/usr/bin/env bash
# Builds the peers of `./run bench --peers DIR` from the sources that the user has put into DIR, and downloads nothing:
#
#   peers.sh DIR OUT     DIR/mujoco, DIR/pinocchio, DIR/crocoddyl: source folders, or installations with include and lib
#
# What is built is in OUT/build, what is installed in OUT/prefix. Other folders of DIR are given to CMake's FetchContent
# under their names (MuJoCo's: qhull, ccd, tinyxml2, tinyobjloader, miniz, lodepng, marchingcubecpp). A peer that is not
# in DIR, or whose build fails, is named, and left out. Peers that are installed already are not built anew.
set -euo pipefail
source_dir=$(readlink -f "$1") out=$2
mkdir -p "$out/prefix" "$out/build"
out=$(readlink -f "$out")
prefix=$out/prefix jobs=${JOBS:-$(nproc)}

say() { printf '==> %s\n' "$*" >&2; }

# These options of each peer build its library alone.
# MuJoCo links by lld where that is installed, which makes an empty library of what GCC leaves for link-time optimisation.
mujoco=(-DCMAKE_INTERPROCEDURAL_OPTIMIZATION=OFF -DMUJOCO_BUILD_EXAMPLES=OFF -DMUJOCO_BUILD_SIMULATE=OFF
        -DMUJOCO_BUILD_TESTS=OFF -DMUJOCO_TEST_PYTHON_UTIL=OFF)
pinocchio=(-DBUILD_PYTHON_INTERFACE=OFF -DBUILD_WITH_URDF_SUPPORT=OFF -DENABLE_TEMPLATE_INSTANTIATION=OFF)
crocoddyl=(-DBUILD_PYTHON_INTERFACE=OFF -DBUILD_EXAMPLES=OFF -DBUILD_BENCHMARK=OFF -DBUILD_WITH_IPOPT=OFF)
shared=(-DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF -DINSTALL_DOCUMENTATION=OFF -DCMAKE_INSTALL_LIBDIR=lib
        -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_INSTALL_PREFIX="$prefix" -DFETCHCONTENT_FULLY_DISCONNECTED=ON
        -DCMAKE_POLICY_VERSION_MINIMUM=3.5)

# Folders for FetchContent, by name.
for folder in "$source_dir"/*/; do
  name=$(basename "$folder")
  shared+=("-DFETCHCONTENT_SOURCE_DIR_${name^^}=${folder%/}")
done

# MuJoCo brings the CMake file of a dependency that has none.
for file in "$source_dir"/mujoco/cmake/third_party_deps/*/CMakeLists.txt; do
  target=$source_dir/$(basename "$(dirname "$file")")
  [[ ! -d $target || -e $target/CMakeLists.txt || ! -f $file ]] || cp "$file" "$target/"
done

# install NAME OPTION...
install() {
  local name=$1 folder=$source_dir/$1 log=$out/$1.log
  shift
  if [[ ! -d $folder ]]; then
    say "skipped: $source_dir has no $name"
  elif [[ ! -f $folder/CMakeLists.txt ]]; then
    say "$name: installed in $folder"
    cp -a "$folder/." "$prefix/"
  elif [[ -e $out/$name.done ]]; then
    say "$name: built before, in $out/build/$name"
  else
    say "$name: building, the log is $log"
    if cmake -S "$folder" -B "$out/build/$name" "${shared[@]}" "$@" >"$log" 2>&1 &&
      cmake --build "$out/build/$name" -j "$jobs" >>"$log" 2>&1 &&
      cmake --install "$out/build/$name" >>"$log" 2>&1; then
      touch "$out/$name.done"
    else
      say "skipped: $name could not be built, $log says why: $(grep -m1 -iE 'error' "$log" || tail -1 "$log")"
    fi
  fi
}

install mujoco "${mujoco[@]}"
install pinocchio "${pinocchio[@]}"
install crocoddyl "${crocoddyl[@]}"
