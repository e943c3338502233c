# Compiles for 64-bit ARM on another machine, with Debian's aarch64-linux-gnu-g++; tests run under qemu. The commands:
# docs/on_your_cluster.md, "ARM". TETSUAME_SYSROOT, here or in the environment: the folder with Debian's libraries for arm64.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

set(TETSUAME_SYSROOT "$ENV{TETSUAME_SYSROOT}" CACHE PATH "Debian's libraries for arm64")
if(NOT IS_DIRECTORY "${TETSUAME_SYSROOT}/usr/lib/aarch64-linux-gnu")
  message(FATAL_ERROR "TETSUAME_SYSROOT is to name the folder with the libraries for arm64 (docs/on_your_cluster.md, ARM); "
                      "there are none in '${TETSUAME_SYSROOT}'")
endif()
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES TETSUAME_SYSROOT)
set(CMAKE_SYSROOT ${TETSUAME_SYSROOT})
set(CMAKE_FIND_ROOT_PATH ${TETSUAME_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(what IN ITEMS LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${what} ONLY)
endforeach()
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${TETSUAME_SYSROOT})

# The compiler wrappers of MPI and HDF5 would tell of this machine's libraries.
set(libraries ${TETSUAME_SYSROOT}/usr/lib/aarch64-linux-gnu)
set(MPI_SKIP_COMPILER_WRAPPER ON)
set(MPI_CXX_SKIP_MPICXX ON)
set(MPI_mpi_LIBRARY ${libraries}/openmpi/lib/libmpi.so)
foreach(language IN ITEMS C CXX)
  set(MPI_${language}_COMPILER_INCLUDE_DIRS ${libraries}/openmpi/include)
  set(MPI_${language}_LIB_NAMES mpi)
endforeach()
set(HDF5_ROOT ${libraries}/hdf5/openmpi)
