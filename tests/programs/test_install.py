"""What `cmake --install` and the Debian package put in place: programs and the Python package, in a folder of anyone's."""

import shutil
import subprocess
import unittest

from running import INPUTS, PROGRAMS, SLOW, Case, environment

BUILD = PROGRAMS.parent


class Installed(Case):
    def run_from(self, prefix):
        """A run by the program in bin, with nothing of the build's folder in the environment, and a picture of it."""
        own = environment(1, True) | {"PATH": f"{prefix}/bin:/usr/bin:/bin", "MPLBACKEND": "Agg"}
        out = self.here / "out"
        for command in (["disph_c", prefix / "share/tetsuame/inputs/hydrostatic_13.nml", "--set", "time.steps=5", "--output", out],
                        ["tetsuame", "plot", out, "--fields", "Pressure"],
                        ["tetsuame", "sweep", INPUTS / "hydrostatic_13.nml", "--program", "disph_f", "--set", "time.steps=2,3", "--output", self.here / "sweep"]):
            said = subprocess.run([str(word) for word in command], env=own, cwd=self.here, capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
        self.assertTrue((out / "plots/map.png").exists())
        self.assertEqual(len((self.here / "sweep/sweep.csv").read_text().splitlines()), 3)

    def test_cmake_install(self):
        prefix = self.here / "local"
        said = subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.run_from(prefix)

    def test_package(self):
        if not SLOW:
            self.skipTest("a minute")
        if not all(shutil.which(tool) for tool in ("cpack", "dpkg-deb", "dpkg-shlibdeps")):
            self.skipTest("no dpkg-dev")
        said = subprocess.run(["cpack", "-G", "DEB", "-B", self.here / "package"], cwd=BUILD, capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        package, = (self.here / "package").glob("tetsuame_*.deb")
        needs = subprocess.run(["dpkg-deb", "-f", package, "Depends"], capture_output=True, text=True).stdout
        for library in ("libhdf5", "libsundials", "libopenmpi3"):
            self.assertIn(library, needs)
        subprocess.run(["dpkg-deb", "-x", package, self.here / "root"], check=True)
        self.run_from(self.here / "root/usr")


if __name__ == "__main__":
    unittest.main()
