#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Robots with certificates of one authority understand each other; one without hears nothing, and is not heard.

Usage: fleet_secure.py SEQLOOP    exit code 77 without Cyclone DDS's plug-ins, or without openssl
"""
import glob
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds.fleet import Robot, drive, expect, way  # noqa: E402

HEAD = '<?xml version="1.0" encoding="utf-8"?>\n<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">\n'
DOMAINS = "<domains><id_range><min>0</min><max>230</max></id_range></domains>"

GOVERNANCE = HEAD + f"""<domain_access_rules><domain_rule>{DOMAINS}
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>NONE</rtps_protection_kind>
<topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind>
<data_protection_kind>ENCRYPT</data_protection_kind></topic_rule></topic_access_rules>
</domain_rule></domain_access_rules></dds>
"""

PERMISSIONS = HEAD + """<permissions><grant name="NAME"><subject_name>CN=NAME</subject_name>
<validity><not_before>2020-01-01T00:00:00</not_before><not_after>2100-01-01T00:00:00</not_after></validity>
<allow_rule>""" + DOMAINS + """
<publish><topics><topic>*</topic></topics><partitions><partition>*</partition></partitions></publish>
<subscribe><topics><topic>*</topic></topics><partitions><partition>*</partition></partitions></subscribe>
</allow_rule><default>DENY</default></grant></permissions></dds>
"""


def openssl(work: pathlib.Path, *words: str) -> None:
    subprocess.run(["openssl", *words], cwd=work, check=True, capture_output=True)


def sign(work: pathlib.Path, name: str, text: str) -> None:
    (work / f"{name}.xml").write_text(text)
    openssl(work, "smime", "-sign", "-in", f"{name}.xml", "-text", "-out", f"{name}.p7s", "-signer", "ca.pem",
            "-inkey", "ca.key")


def library(plugins: pathlib.Path, name: str, word: str) -> str:
    return (f'<Library path="{plugins}/libdds_security_{name}.so" initFunction="init_{word}" '
            f'finalizeFunction="finalize_{word}"/>')


def certified(work: pathlib.Path, plugins: pathlib.Path, name: str) -> str:
    """@return what Cyclone DDS is told"""
    openssl(work, "req", "-newkey", "rsa:2048", "-nodes", "-keyout", f"{name}.key", "-out", f"{name}.csr", "-subj",
            f"/CN={name}")
    openssl(work, "x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial",
            "-days", "1000", "-out", f"{name}.pem")
    sign(work, name, PERMISSIONS.replace("NAME", name))
    return f"""<CycloneDDS><Domain><Security>
<Authentication>{library(plugins, "auth", "authentication")}<IdentityCA>file:{work}/ca.pem</IdentityCA>
<IdentityCertificate>file:{work}/{name}.pem</IdentityCertificate><PrivateKey>file:{work}/{name}.key</PrivateKey>
</Authentication>
<AccessControl>{library(plugins, "ac", "access_control")}<PermissionsCA>file:{work}/ca.pem</PermissionsCA>
<Governance>file:{work}/governance.p7s</Governance><Permissions>file:{work}/{name}.p7s</Permissions></AccessControl>
<Cryptographic>{library(plugins, "crypto", "crypto")}</Cryptographic>
</Security></Domain></CycloneDDS>"""


def main(seqloop: str, plugins: pathlib.Path, work: pathlib.Path) -> None:
    openssl(work, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1000", "-keyout", "ca.key", "-out",
            "ca.pem", "-subj", "/CN=fleet")
    sign(work, "governance", GOVERNANCE)
    seen = way(800)
    robots = [Robot(seqloop, work, name, drive(work, name, seen, seed), f"{name}.seqloop", network=network)
              for seed, (name, network) in enumerate((("anna", certified(work, plugins, "anna")),
                                                      ("bert", certified(work, plugins, "bert")), ("carl", "")))]
    for robot in robots:
        robot.end()
    anna, bert, carl = (robot.counted() for robot in robots)
    expect(anna[1] == 1 and bert[1] == 1, f"two of one authority know each other's places: {anna}, {bert}")
    expect(carl == (0, 0), f"a third knows none: {carl}")


if __name__ == "__main__":
    found = glob.glob("/usr/lib/*/libddsc0debian/libdds_security_auth.so")
    if not found or shutil.which("openssl") is None:
        print("Cyclone DDS's security plug-ins, or openssl, are missing")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], pathlib.Path(found[0]).parent, pathlib.Path(folder))
