"""bench/peers.sh builds the given sources, uses installed peers, and names those that it leaves out."""

import pathlib
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]

BUILT = """cmake_minimum_required(VERSION 3.22)
project(mujoco LANGUAGES NONE)
if(NOT FETCHCONTENT_FULLY_DISCONNECTED OR NOT EXISTS "${FETCHCONTENT_SOURCE_DIR_QHULL}/CMakeLists.txt")
  message(FATAL_ERROR "it would download")
endif()
install(FILES mujoco.h DESTINATION include/mujoco)
"""
BROKEN = """cmake_minimum_required(VERSION 3.22)
project(pinocchio LANGUAGES NONE)
message(FATAL_ERROR "Boost is not here")
"""


def check(holds, what):
    if not holds:
        sys.exit(f"peers_test.py: {what}")


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def run(source, out):
    done = subprocess.run([str(TOP / "bench/peers.sh"), str(source), str(out)], text=True, capture_output=True)
    check(done.returncode == 0, done.stderr)
    return done.stderr


def main():
    with tempfile.TemporaryDirectory() as folder:
        source, out = pathlib.Path(folder) / "source", pathlib.Path(folder) / "out"
        source.mkdir()
        text = run(source, out)
        for name in ("mujoco", "pinocchio", "crocoddyl"):
            check(f"skipped: {source} has no {name}" in text, text)

        write(source / "mujoco/CMakeLists.txt", BUILT)
        write(source / "mujoco/mujoco.h", "#define mjVERSION_HEADER 1\n")
        write(source / "mujoco/cmake/third_party_deps/qhull/CMakeLists.txt", "# of a dependency that has none\n")
        (source / "qhull").mkdir()
        write(source / "pinocchio/CMakeLists.txt", BROKEN)
        write(source / "crocoddyl/include/crocoddyl/config.hh", "// installed\n")
        text = run(source, out)
        check((out / "prefix/include/mujoco/mujoco.h").exists(), f"MuJoCo was not installed: {text}")
        check((out / "prefix/include/crocoddyl/config.hh").exists(), f"Crocoddyl's installation was not taken: {text}")
        check("skipped: pinocchio could not be built" in text and str(out / "pinocchio.log") in text, text)
        check("Boost is not here" in (out / "pinocchio.log").read_text(), "the log does not say why")

        text = run(source, out)
        check("mujoco: built before" in text, text)


if __name__ == "__main__":
    main()
