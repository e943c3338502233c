# A recipe for Spack: `spack repo add docs/spack`, then `spack install tetsuame`.
import os

from spack.package import *


class Tetsuame(CMakePackage):
    """Particle code for the interiors of planets: density-independent SPH for core formation and mantle convection."""

    # The checkout that the recipe stands in.
    git = "file://" + os.path.abspath(os.path.join(os.path.dirname(__file__), *[os.pardir] * 4))

    license("MIT", checked_by="tetsuame")

    version("main", branch="main")

    variant("tests", default=False, description="Build what the tests need")
    variant("avx512", default=True, description="Programs for processors with AVX-512 beside those for AVX2", when="target=x86_64_v3:")
    variant("stl", default=False, description="Walls from surfaces of triangles (CGAL, under the GPL)")
    variant("expressions", default=True, description="Expressions of the place in &region (muParser)")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("ninja", type="build")
    depends_on("mpi")
    depends_on("hdf5")
    depends_on("sundials@6.4:7+mpi+arkode+kinsol")
    depends_on("boost@1.74:")
    depends_on("boost@1.74:+test", when="+tests")
    depends_on("fmt")
    depends_on("nlohmann-json")
    depends_on("cli11")
    depends_on("eigen")
    depends_on("cgal@5.5:5", when="+stl")
    depends_on("muparser", when="+expressions")
    depends_on("python@3.9:", type="run")
    depends_on("py-numpy", type="run")
    depends_on("py-h5py", type="run")
    depends_on("py-matplotlib", type="run")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("BUILD_TESTING", "tests"),
            self.define_from_variant("TETSUAME_AVX512", "avx512"),
        ]
