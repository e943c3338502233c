"""The recipe for Spack, run with stand-ins for Spack's own functions: what CMakeLists.txt asks for, it installs. The container's file:
what it copies and runs is there."""
import re
import sys
import types
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Packages of Spack by what find_package calls them; OpenMP and threads come with the compiler.
NAMES = {"MPI": "mpi", "HDF5": "hdf5", "SUNDIALS": "sundials", "Boost": "boost", "fmt": "fmt", "nlohmann_json": "nlohmann-json",
         "CLI11": "cli11", "Eigen3": "eigen", "CGAL": "cgal", "muparser": "muparser"}


class Spack(unittest.TestCase):
    def recipe(self):
        needs, said = [], types.ModuleType("spack.package")
        for word in ("license", "version", "variant", "generator"):
            setattr(said, word, lambda *_, **__: None)
        said.depends_on = lambda spec, **_: needs.append(spec)
        said.CMakePackage = type("CMakePackage", (), {"define_from_variant": lambda self, key, name: f"-D{key}={name}"})
        sys.modules.update({"spack": types.ModuleType("spack"), "spack.package": said})
        path = ROOT / "docs/spack/packages/tetsuame/package.py"
        scope = {"__file__": str(path)}
        exec(compile(path.read_text(), str(path), "exec"), scope)
        return scope["Tetsuame"], needs

    def test_what_is_needed(self):
        package, needs = self.recipe()
        asked = set()
        for path in [ROOT / "CMakeLists.txt", *ROOT.glob("modules/**/CMakeLists.txt"), *ROOT.glob("programs/**/CMakeLists.txt")]:
            asked |= set(re.findall(r"find_package\((\w+)", path.read_text()))
        names = {re.split(r"[@+~]", spec)[0] for spec in needs}
        for name in asked - {"OpenMP", "Threads"}:
            self.assertIn(NAMES[name], names)
        self.assertEqual(Path(package.git.removeprefix("file://")), ROOT)
        options = {argument[2:].split("=")[0] for argument in package().cmake_args()}
        text = (ROOT / "CMakeLists.txt").read_text() + (ROOT / "cmake/tetsuame.cmake").read_text()
        for option in options:
            self.assertIn(option, text)


class Container(unittest.TestCase):
    def test_commands(self):
        lines = (ROOT / "docs/Containerfile").read_text().splitlines()
        self.assertTrue(all(line.startswith(("#", "FROM ", "RUN ", "COPY ", "WORKDIR ", "ENV ", "CMD ")) for line in lines), lines)
        options = re.search(r"^RUN (\./run build.*)$", "\n".join(lines), re.MULTILINE)[1].split()[2:]
        for option in options:
            self.assertIn(option, (ROOT / "run").read_text())


if __name__ == "__main__":
    unittest.main()
