#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The installed folder share/seqloop_msgs is a package that ROS 2's own tools build.

They are Debian's (ament-cmake, rosidl-generator-c-cpp). What Debian has not of ROS 2, the standard
messages and what chooses generators, is put together here.

Usage: package.py ROOT BUILD
Exit code 77 where the tools are missing; with SEQLOOP_REQUIRE_DATA set, that fails.
"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

GENERATORS = ("rosidl_cmake", "rosidl_generator_c", "rosidl_generator_cpp",
              "rosidl_typesupport_introspection_c", "rosidl_typesupport_introspection_cpp")
RUNTIME = ("rosidl_runtime_c", "rosidl_runtime_cpp", "rosidl_typesupport_introspection_c",
           "rosidl_typesupport_introspection_cpp")
PYTHON = "-DPython3_EXECUTABLE=/usr/bin/python3"  # Debian's, which has these tools' modules

USER = """
#include <seqloop_msgs/msg/loop_closure.hpp>
#include <seqloop_msgs/msg/status.hpp>
int main() {
  seqloop_msgs::msg::LoopClosure loop;
  loop.match_stamp.sec = 1;
  loop.relative_pose.resize(1);
  seqloop_msgs::msg::Status status;
  return loop.robot.empty() && status.misses == 0 && loop.header.stamp.sec == 0 ? 0 : 1;
}
"""


def call(*command: object, **how) -> None:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **how)
    if done.returncode != 0:
        sys.exit(f"failed: {command}\n{done.stdout}{done.stderr}")


def standard_package(folder: pathlib.Path, name: str, definitions: dict, ours: str) -> None:
    """A package as ours, of standard messages. @param ours CMakeLists.txt, package.xml of ours"""
    (folder / "msg").mkdir(parents=True)
    files = []
    for message, text in definitions.items():
        if message.split("/")[0] != name:
            continue
        files.append(f"msg/{message.split('/')[-1]}.msg")
        (folder / files[-1]).write_text(text + "\n")
    needs = [] if name == "builtin_interfaces" else ["builtin_interfaces"]
    needs += ["std_msgs"] if name == "geometry_msgs" else []
    (folder / "package.xml").write_text(
        ours.replace("<name>seqloop_msgs", f"<name>{name}").replace(f"  <depend>{name}</depend>\n", ""))
    (folder / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject({name})\nfind_package(ament_cmake REQUIRED)\n"
        "find_package(rosidl_default_generators REQUIRED)\n"
        + "".join(f"find_package({need} REQUIRED)\n" for need in needs)
        + f"rosidl_generate_interfaces({name} {' '.join(files)}"
        + (f" DEPENDENCIES {' '.join(needs)}" if needs else "")
        + ")\nament_export_dependencies(rosidl_default_runtime)\nament_package()\n")


def main() -> None:
    root, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    if not all(pathlib.Path(f"/usr/share/{tool}/cmake").is_dir() for tool in ("ament_cmake", "rosidl_generator_cpp")):
        print("Debian's ament-cmake and rosidl-generator-c-cpp are not installed")
        sys.exit(1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77)
    spec = importlib.util.spec_from_file_location("ros_types", root / "tests/ros/types.py")
    types = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(types)
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        prefix = work / "install"
        call("cmake", "--install", build / "platform/ros", "--prefix", work / "seqloop")
        ours = work / "seqloop/share/seqloop_msgs"
        for chooser, chosen in (("rosidl_default_generators", GENERATORS), ("rosidl_default_runtime", RUNTIME)):
            config = prefix / f"share/{chooser}/cmake"
            config.mkdir(parents=True)
            (config / f"{chooser}Config.cmake").write_text(
                "".join(f"find_package({tool} REQUIRED)\n" for tool in chosen))
        packages = {"seqloop_msgs": ours}
        for package in ("builtin_interfaces", "std_msgs", "geometry_msgs"):
            packages[package] = work / package
            standard_package(work / package, package, types.STANDARD, (ours / "package.xml").read_text())
        for package in ("builtin_interfaces", "std_msgs", "geometry_msgs", "seqloop_msgs"):
            made = work / f"build_{package}"
            call("cmake", "-S", packages[package], "-B", made, f"-DCMAKE_PREFIX_PATH={prefix}",
                 f"-DCMAKE_INSTALL_PREFIX={prefix}", PYTHON, "-DCMAKE_BUILD_TYPE=Debug", "-DBUILD_TESTING=OFF")
            call("cmake", "--build", made, "--parallel", 2)
            call("cmake", "--install", made)
            print(f"{package}: built by ROS 2's tools")
        user = work / "user"
        user.mkdir()
        (user / "main.cpp").write_text(USER)
        (user / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(user)\nfind_package(seqloop_msgs REQUIRED)\n"
            "add_executable(user main.cpp)\ntarget_link_libraries(user ${seqloop_msgs_TARGETS})\n"
            "target_compile_features(user PRIVATE cxx_std_17)\n")
        call("cmake", "-S", user, "-B", user / "build", f"-DCMAKE_PREFIX_PATH={prefix}", PYTHON)
        call("cmake", "--build", user / "build")
        call(user / "build/user", env={**os.environ, "LD_LIBRARY_PATH": str(prefix / "lib")})
        print("a program that uses the messages runs")


if __name__ == "__main__":
    main()
