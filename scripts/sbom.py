"""An SBOM of what was built (SPDX 2.3, JSON): sbom.py BUILD VERSION OUT

The Debian packages of the shared libraries that BUILD's programs and libraries load, and of the headers that the compiler read
(ninja's record of them), each with its version, as dpkg knows them."""
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys


def lines_of(*command):
    return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()


def packages_of(files):
    """Names of the Debian packages that files belong to."""
    found = set()
    files = sorted({os.path.realpath(file) for file in files} | set(files))
    for first in range(0, len(files), 500):
        for line in lines_of("dpkg-query", "-S", *files[first:first + 500]):
            if not line.startswith("diversion"):
                found.update(name.split(":")[0].strip() for name in line.rsplit(": ", 1)[0].split(","))
    return found


def binaries(build):
    for file in sorted(build.rglob("*")):
        if file.is_file() and not file.is_symlink() and "CMakeFiles" not in file.parts and "_CPack_Packages" not in file.parts:
            with open(file, "rb") as opened:
                if opened.read(4) == b"\x7fELF":
                    yield file


def main():
    build, version, out = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    loaded = {word for file in binaries(build) for line in lines_of("ldd", str(file))
              for word in re.findall(r"=> (/\S+)", line) if build.resolve() not in pathlib.Path(word).parents}
    read = {line.strip() for line in lines_of("ninja", "-C", str(build), "-t", "deps") if line.startswith("    /usr/")}
    linked, compiled = packages_of(loaded), packages_of(read)
    if not linked or not compiled:
        sys.exit(f"sbom: {build} holds nothing that was built, or dpkg knows nothing of it")
    versions = dict(line.split("\t") for line in lines_of("dpkg-query", "-W", "-f", "${Package}\t${Version}\n", *sorted(linked | compiled)))
    release = dict(line.split("=", 1) for line in pathlib.Path("/etc/os-release").read_text().splitlines() if "=" in line)
    distribution = release["ID"].strip('"')

    def entry(name):
        return {"SPDXID": "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", name), "name": name, "versionInfo": versions[name],
                "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
                "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                  "referenceLocator": f"pkg:deb/{distribution}/{name}@{versions[name]}"}]}

    when = datetime.datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH") or lines_of("git", "log", "-1", "--format=%ct")[0]),
                                           datetime.timezone.utc)
    own = {"SPDXID": "SPDXRef-trilens", "name": "trilens", "versionInfo": version, "downloadLocation": "NOASSERTION",
           "filesAnalyzed": False, "licenseConcluded": "Apache-2.0", "licenseDeclared": "Apache-2.0"}
    relations = [("SPDXRef-DOCUMENT", "DESCRIBES", "SPDXRef-trilens")]
    relations += [("SPDXRef-trilens", "DYNAMIC_LINK", entry(name)["SPDXID"]) for name in sorted(linked)]
    relations += [(entry(name)["SPDXID"], "BUILD_DEPENDENCY_OF", "SPDXRef-trilens") for name in sorted(compiled - linked)]
    document = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"trilens-{version}",
                "documentNamespace": "https://spdx.org/spdxdocs/trilens-%s-%s" % (version, hashlib.sha256(
                    json.dumps(sorted(versions.items())).encode()).hexdigest()[:16]),
                "creationInfo": {"created": when.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: trilens scripts/sbom.py"]},
                "packages": [own] + [entry(name) for name in sorted(versions)],
                "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations]}
    out.write_text(json.dumps(document, indent=1) + "\n")
    print(f"{out}: {len(linked)} packages linked with, {len(compiled - linked)} more built from", file=sys.stderr)


main()
