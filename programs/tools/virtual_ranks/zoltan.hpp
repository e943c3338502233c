// Zoltan's geometric partitioners, for comparison [K. Devine et al., Comput. Sci. Eng. 4 (2), 90 (2002)]:
// recursive coordinate bisection (rcb) and the Hilbert space-filling curve (hsfc), called in one process
// for as many parts as there are virtual ranks.
#pragma once

#include <mpi.h>
#if TETSUAME_ZOLTAN
#include <zoltan.h>
#endif

#include <array>
#include <foundation/error.hpp>
#include <numeric>
#include <string>
#include <vector>

namespace tetsuame::virtual_ranks {

// Whether this program is built with Zoltan. Without, no input may ask for a partitioner.
constexpr bool with_zoltan = TETSUAME_ZOLTAN;

#if TETSUAME_ZOLTAN
template <int D>
struct objects {
  const std::vector<std::array<double, D>>& x;
  const std::vector<float>& weights;

  static const objects& of(void* data, int* fault) {
    *fault = ZOLTAN_OK;
    return *static_cast<const objects*>(data);
  }
  static int count(void* data, int* fault) { return static_cast<int>(of(data, fault).x.size()); }
  static int dimension(void*, int* fault) {
    *fault = ZOLTAN_OK;
    return D;
  }
  static void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int weight_dim, float* weight,
                   int* fault) {
    const auto& o = of(data, fault);
    for (std::size_t i = 0; i < o.x.size(); ++i) global[i] = local[i] = static_cast<ZOLTAN_ID_TYPE>(i);
    if (weight_dim > 0) std::copy(o.weights.begin(), o.weights.end(), weight);
  }
  static void places(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int, double* out, int* fault) {
    const auto& o = of(data, fault);
    for (int i = 0; i < n; ++i) out = std::copy_n(o.x[local[i]].begin(), D, out);
  }
};

inline void expect(int status, const char* call) {
  if (status != ZOLTAN_OK && status != ZOLTAN_WARN)
    foundation::fail_calculation(std::string("Zoltan's ") + call + " failed; its message stands above");
}

struct zoltan {
  Zoltan_Struct* z = Zoltan_Create(MPI_COMM_SELF);
  ~zoltan() { Zoltan_Destroy(&z); }
};
#endif

// The part of each particle. weights: of each particle; empty: all equal. sizes: what part of the weight each
// part should get, up to a common factor. Throws fail_calculation if Zoltan refuses.
template <int D>
std::vector<int> partition([[maybe_unused]] const std::string& method, const std::vector<std::array<double, D>>& x,
                           [[maybe_unused]] const std::vector<float>& weights,
                           [[maybe_unused]] const std::vector<double>& sizes) {
  std::vector<int> part(x.size(), 0);
#if TETSUAME_ZOLTAN
  float version = 0.0F;
  expect(Zoltan_Initialize(0, nullptr, &version), "Initialize");
  zoltan own;
  auto* z = own.z;
  for (const auto& [key, value] : {std::pair<const char*, std::string>{"DEBUG_LEVEL", "0"},
                                   {"LB_METHOD", method == "hsfc" ? "HSFC" : "RCB"},
                                   {"NUM_GID_ENTRIES", "1"},
                                   {"NUM_LID_ENTRIES", "1"},
                                   {"NUM_GLOBAL_PARTS", std::to_string(sizes.size())},
                                   {"RETURN_LISTS", "PARTS"},
                                   {"OBJ_WEIGHT_DIM", weights.empty() ? "0" : "1"},
                                   {"IMBALANCE_TOL", "1.0"},
                                   {"REMAP", "0"}})
    expect(Zoltan_Set_Param(z, key, value.c_str()), "Set_Param");

  objects<D> all{x, weights};
  expect(Zoltan_Set_Num_Obj_Fn(z, objects<D>::count, &all), "Set_Num_Obj_Fn");
  expect(Zoltan_Set_Obj_List_Fn(z, objects<D>::list, &all), "Set_Obj_List_Fn");
  expect(Zoltan_Set_Num_Geom_Fn(z, objects<D>::dimension, &all), "Set_Num_Geom_Fn");
  expect(Zoltan_Set_Geom_Multi_Fn(z, objects<D>::places, &all), "Set_Geom_Multi_Fn");
  std::vector<int> ids(sizes.size()), weight_index(sizes.size(), 0);
  std::iota(ids.begin(), ids.end(), 0);
  std::vector<float> part_sizes(sizes.begin(), sizes.end());
  expect(
      Zoltan_LB_Set_Part_Sizes(z, 1, static_cast<int>(ids.size()), ids.data(), weight_index.data(), part_sizes.data()),
      "LB_Set_Part_Sizes");

  int changes = 0, gid = 1, lid = 1, n_import = 0, n_export = 0;
  ZOLTAN_ID_PTR import_global = nullptr, import_local = nullptr, export_global = nullptr, export_local = nullptr;
  int *import_ranks = nullptr, *import_parts = nullptr, *export_ranks = nullptr, *export_parts = nullptr;
  expect(Zoltan_LB_Partition(z, &changes, &gid, &lid, &n_import, &import_global, &import_local, &import_ranks,
                             &import_parts, &n_export, &export_global, &export_local, &export_ranks, &export_parts),
         "LB_Partition");
  for (int k = 0; k < n_export; ++k) part[export_local[k]] = export_parts[k];
  Zoltan_LB_Free_Part(&import_global, &import_local, &import_ranks, &import_parts);
  Zoltan_LB_Free_Part(&export_global, &export_local, &export_ranks, &export_parts);
#endif
  return part;
}

}  // namespace tetsuame::virtual_ranks
