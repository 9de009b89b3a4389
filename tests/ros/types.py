#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares the types that DDS carries with the definitions of ROS 2, and with our own in platform/ros/msg:
the fields in idl/, the type hashes in platform/dds/topic_type.cpp (REP 2011), and what package/ builds.

Usage: types.py ROOT    exit code 1 and a line a fault where something differs.
"""
import hashlib
import json
import pathlib
import re
import sys

# From common_interfaces and rcl_interfaces, without comments and constants.
STANDARD = {
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "sensor_msgs/msg/Image": "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
                             "uint8 is_bigendian\nuint32 step\nuint8[] data",
    "sensor_msgs/msg/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "diagnostic_msgs/msg/KeyValue": "string key\nstring value",
    "diagnostic_msgs/msg/DiagnosticStatus": "byte level\nstring name\nstring message\n"
                                            "string hardware_id\nKeyValue[] values",
    "diagnostic_msgs/msg/DiagnosticArray": "std_msgs/Header header\nDiagnosticStatus[] status",
    "geometry_msgs/msg/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/msg/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/msg/Pose": "Point position\nQuaternion orientation",
    "geometry_msgs/msg/PoseWithCovariance": "Pose pose\nfloat64[36] covariance",
    "geometry_msgs/msg/PoseWithCovarianceStamped":
        "std_msgs/Header header\nPoseWithCovariance pose",
    "geometry_msgs/msg/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/msg/Twist": "Vector3 linear\nVector3 angular",
    "geometry_msgs/msg/TwistWithCovariance": "Twist twist\nfloat64[36] covariance",
    "nav_msgs/msg/Odometry": "std_msgs/Header header\nstring child_frame_id\n"
                             "geometry_msgs/PoseWithCovariance pose\n"
                             "geometry_msgs/TwistWithCovariance twist",
    "std_msgs/msg/String": "string data",
}

# As ROS 2 publishes them: they show that the hashes are computed right.
PUBLISHED = {
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "std_msgs/msg/Header": "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
}

NUMBERS = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8,
           "uint64": 9, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17}
ARRAY, BOUNDED, UNBOUNDED = 48, 96, 144

# What idlc calls them.
IN_IDL = {"uint8": "octet", "byte": "octet", "int32": "long", "uint32": "unsigned long",
          "uint64": "unsigned long long", "float64": "double", "bool": "boolean", "string": "string"}


def fields(definition: str, package: str) -> list[tuple[str, str, str]]:
    """Name, type (with its package, unless it is a number) and [], [N] or [<=N] of each field."""
    found = []
    for line in definition.splitlines():
        match = re.match(r"([\w/]+)(\[(?:<=)?\d*\])?\s+(\w+)", line.split("#")[0].strip())
        if not match:
            continue
        kind, brackets, name = match[1], match[2] or "", match[3]
        if kind not in NUMBERS:
            kind = kind.replace("/", "/msg/") if "/" in kind else f"{package}/msg/{kind}"
        found.append((name, kind, brackets))
    return found


def described(name: str, definitions: dict, used: dict) -> dict:
    rows = []
    for field, kind, brackets in fields(definitions[name], name.split("/")[0]):
        size = int(re.sub(r"\D", "", brackets) or 0)
        extra = (0 if not brackets else BOUNDED if "<" in brackets else ARRAY if size else UNBOUNDED)
        number = NUMBERS.get(kind, 1)
        if kind not in NUMBERS and kind not in used:
            used[kind] = None
            used[kind] = described(kind, definitions, used)
        rows.append({"name": field,
                     "type": {"type_id": number + extra, "capacity": size, "string_capacity": 0,
                              "nested_type_name": "" if kind in NUMBERS else kind}})
    return {"type_name": name, "fields": rows}


def type_hash(name: str, definitions: dict) -> str:
    used: dict = {}
    whole = {"type_description": described(name, definitions, used),
             "referenced_type_descriptions": [used[key] for key in sorted(used)]}
    text = json.dumps(whole, separators=(", ", ": "), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def idl_structs(text: str) -> dict:
    """Fields of every struct, as in the file."""
    text = re.sub(r"//.*", "", text)
    found = {}
    for match in re.finditer(r"module (\w+) \{ module msg \{ module dds_ \{(.*?)\n\}; \}; \};", text,
                             re.S):
        for struct in re.finditer(r"@final struct (\w+)_ \{(.*?)\};", match[2], re.S):
            lines = [" ".join(line.split()) for line in struct[2].split(";") if line.strip()]
            found[f"{match[1]}/msg/{struct[1]}"] = lines
    return found


def as_idl(name: str, definition: str) -> list[str]:
    package = name.split("/")[0]
    lines = []
    for field, kind, brackets in fields(definition, package):
        words = IN_IDL.get(kind)
        if words is None:
            other, _, short = kind.split("/")
            words = f"{short}_" if other == package else f"{other}::msg::dds_::{short}_"
        if brackets and brackets != "[]" and "<" not in brackets:
            lines.append(f"{words} {field}{brackets}")
        elif brackets:
            bound = re.sub(r"\D", "", brackets)
            lines.append(f"sequence<{words}{', ' + bound if bound else ''}> {field}")
        else:
            lines.append(f"{words} {field}")
    return lines


def main() -> int:
    root = pathlib.Path(sys.argv[1])
    definitions = dict(STANDARD)
    for file in (root / "platform/ros/msg").glob("*.msg"):
        definitions[f"seqloop_msgs/msg/{file.stem}"] = file.read_text(encoding="utf-8")
    faults = [f"{name}: the hash is not the published one" for name, published in PUBLISHED.items()
              if type_hash(name, definitions) != published]
    structs = {}
    for file in (root / "platform/ros/idl").glob("*.idl"):
        structs.update(idl_structs(file.read_text(encoding="utf-8")))
    for name in definitions:
        if name.startswith("seqloop_msgs") and name not in structs:
            faults.append(f"{name} is not in idl/")
    for name, lines in structs.items():
        if lines != as_idl(name, definitions[name]):
            faults.append(f"{name}: idl has {lines}, the definition {as_idl(name, definitions[name])}")
    code = (root / "platform/dds/topic_type.cpp").read_text(encoding="utf-8")
    rows = re.findall(r'"(\w+/msg/\w+)",\s*"RIHS01_(\w{64})"', code)
    if not rows:
        faults.append("topic_type.cpp has no hashes")
    for name, found in rows:
        if type_hash(name, definitions) != found:
            faults.append(f"{name}: RIHS01_{type_hash(name, definitions)}, not {found}")
    # The package that users of ROS 2 build.
    package = root / "platform/ros/package"
    version = re.search(r"project\(seqloop VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    if f"<version>{version}</version>" not in (package / "package.xml").read_text(encoding="utf-8"):
        faults.append(f"package.xml is not of version {version}")
    built = re.findall(r"msg/(\w+)\.msg", (package / "CMakeLists.txt").read_text(encoding="utf-8"))
    if sorted(f"seqloop_msgs/msg/{name}" for name in built) != sorted(set(definitions) - set(STANDARD)):
        faults.append(f"package/CMakeLists.txt builds {built}")
    print("\n".join(faults) if faults else f"{len(structs)} types and {len(rows)} hashes as defined")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
