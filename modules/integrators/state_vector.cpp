#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <foundation/agree.hpp>
#include <foundation/threads.hpp>
#include <foundation/waiting.hpp>
#include <integrators/state_vector.hpp>
#include <limits>
#include <memory>
#include <new>

namespace tetsuame::integrators {

namespace {

using foundation::exact_sum;

constexpr std::size_t alignment = 64;      // bytes: one cache line, one AVX-512 register
constexpr std::size_t block_length = 512;  // values: what is summed in one local buffer
constexpr double infinity = std::numeric_limits<double>::infinity();

struct release_memory {
  void operator()(double* p) const { std::free(p); }
};
using memory_block = std::unique_ptr<double, release_memory>;

// What a home vector and all its clones share.
struct family {
  MPI_Comm communicator;
  std::size_t fields;
  std::vector<std::size_t> n;  // values of each field
  std::size_t most;            // of any field
  sunindextype global_length;
  long long copies = 0;
  std::vector<memory_block> unused;  // storage given back by clones

  std::size_t stride() const { return (most + 7) / 8 * 8; }
  memory_block take() {
    if (!unused.empty()) {
      memory_block last = std::move(unused.back());
      unused.pop_back();
      return last;
    }
    const std::size_t bytes = std::max(alignment, fields * stride() * sizeof(double));
    memory_block fresh(
        static_cast<double*>(std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)));
    if (!fresh) throw std::bad_alloc();
    return fresh;
  }
};

// Values of one vector or of several with equal values.
struct storage {
  explicit storage(std::shared_ptr<family> f) : owner(std::move(f)), block(owner->take()), pointers(owner->fields) {
    for (std::size_t k = 0; k < owner->fields; ++k) pointers[k] = block.get() + k * owner->stride();
  }
  ~storage() {
    if (owner->unused.empty()) owner->unused.push_back(std::move(block));  // one is all that a step asks for anew
  }
  storage(const storage&) = delete;
  storage& operator=(const storage&) = delete;

  std::shared_ptr<family> owner;
  memory_block block;
  std::vector<double*> pointers;
};

struct content {
  std::shared_ptr<family> shared;
  std::vector<double*> home;        // empty in a clone
  std::shared_ptr<storage> stored;  // a clone's values; in a home vector a storage of equal values, if known
  bool is_home = false;
  double constant = 0.0;  // what a clone without storage holds
};

content& of(N_Vector v) { return *static_cast<content*>(v->content); }
const family& family_of(N_Vector v) { return *of(v).shared; }

double* const* read(N_Vector v) {
  content& c = of(v);
  if (c.is_home) return c.home.data();
  if (!c.stored) {
    c.stored = std::make_shared<storage>(c.shared);
    for (double* values : c.stored->pointers) std::fill_n(values, c.shared->most, c.constant);
  }
  return c.stored->pointers.data();
}

// Where a vector's new values go, and what keeps the old ones alive while they are read.
struct destination {
  double* const* values;
  std::shared_ptr<storage> old;
};

destination overwrite(N_Vector v) {
  content& c = of(v);
  if (c.is_home) {
    c.stored.reset();
    return {c.home.data(), nullptr};
  }
  if (c.stored && c.stored.use_count() == 1) return {c.stored->pointers.data(), nullptr};
  std::shared_ptr<storage> old = std::move(c.stored);
  c.stored = std::make_shared<storage>(c.shared);
  return {c.stored->pointers.data(), std::move(old)};
}

// kernel(field, begin, end) over all values; a thread gets the same particles of every field.
template <class Kernel>
void over_blocks(const family& f, Kernel kernel) {
  foundation::for_chunks(f.most, 4 * block_length, f.most > 8 * block_length, [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first; begin < last; begin += block_length)
      for (std::size_t k = 0; k < f.fields; ++k)
        if (const std::size_t end = std::min({f.n[k], begin + block_length, last}); begin < end) kernel(k, begin, end);
  });
}

// z_i = value(field, i). Reads and the write of one i may concern the same array.
template <class Value>
void assign(N_Vector z, Value value) {
  const destination to = overwrite(z);
  over_blocks(family_of(z), [&](std::size_t k, std::size_t begin, std::size_t end) {
    double* out = to.values[k];
#pragma omp simd
    for (std::size_t i = begin; i < end; ++i) out[i] = value(k, i);
  });
}

// results[j] = the sum over all values of all ranks of term(j, field, i), in one message.
template <class Term>
void sums(const family& f, std::span<double> results, Term term) {
  std::vector<exact_sum> total(results.size());
#pragma omp parallel if (f.most > 8 * block_length)
  {
    std::vector<exact_sum> mine(results.size());
    for (std::size_t j = 0; j < mine.size(); ++j)
      for (std::size_t k = 0; k < f.fields; ++k) {
#pragma omp for schedule(static) nowait
        for (std::size_t i = 0; i < f.n[k]; ++i) mine[j].add(term(j, k, i));
      }
#pragma omp critical(tetsuame_state_vector_sums)
    for (std::size_t j = 0; j < mine.size(); ++j) total[j].add(mine[j]);
  }
  foundation::sum_over_ranks(f.communicator, total, results);
}

template <class Term>
double sum(const family& f, Term term) {
  double result = 0.0;
  sums(f, {&result, 1}, [&](std::size_t, std::size_t k, std::size_t i) { return term(k, i); });
  return result;
}

// The largest value(field, i) of all ranks, or `lowest`.
template <class Value>
double maximum(const family& f, double lowest, Value value) {
  double largest = lowest;
  for (std::size_t k = 0; k < f.fields; ++k) {
#pragma omp parallel for schedule(static) reduction(max : largest) if (f.n[k] > 8 * block_length)
    for (std::size_t i = 0; i < f.n[k]; ++i) {
      const double v = value(k, i);
      largest = std::max(largest, std::isnan(v) ? infinity : v);
    }
  }
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, f.communicator);
  return largest;
}

void copy(N_Vector x, N_Vector z) {
  content &from = of(x), &to = of(z);
  if (x == z) return;
  if (!from.is_home) read(x);  // so that it has storage to share
  if (!to.is_home && from.stored) {
    to.stored = from.stored;
    return;
  }
  if (to.is_home && from.stored && to.stored == from.stored) return;
  double* const* source = read(x);
  const destination target = overwrite(z);
  over_blocks(*to.shared, [&](std::size_t k, std::size_t begin, std::size_t end) {
    std::copy(source[k] + begin, source[k] + end, target.values[k] + begin);
  });
  ++to.shared->copies;
  if (to.is_home)
    to.stored = from.stored;
  else
    from.stored = to.stored;
}

// The operations, in the order of SUNDIALS' table.
N_Vector_ID vector_id(N_Vector) { return SUNDIALS_NVEC_CUSTOM; }

N_Vector clone(N_Vector v) {
  N_Vector w = N_VNewEmpty(v->sunctx);
  if (w == nullptr || N_VCopyOps(v, w) != 0) return nullptr;
  auto fresh = std::make_unique<content>();
  fresh->shared = of(v).shared;
  w->content = fresh.release();
  return w;
}

void destroy(N_Vector v) {
  if (v == nullptr) return;
  delete static_cast<content*>(v->content);
  v->content = nullptr;
  N_VFreeEmpty(v);
}

#if SUNDIALS_VERSION_MAJOR >= 7
SUNComm communicator(N_Vector v) { return of(v).shared->communicator; }
#else
void* communicator(N_Vector v) { return &of(v).shared->communicator; }
#endif
sunindextype global_length(N_Vector v) { return family_of(v).global_length; }

void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
  double *const *px = read(x), *const *py = read(y);
  assign(z, [=](std::size_t k, std::size_t i) { return a * px[k][i] + b * py[k][i]; });
}
void set_constant(double c, N_Vector z) {
  if (!of(z).is_home) {  // until somebody reads it
    of(z).stored.reset();
    of(z).constant = c;
    return;
  }
  assign(z, [=](std::size_t, std::size_t) { return c; });
}
template <auto f>
void of_two(N_Vector x, N_Vector y, N_Vector z) {
  double *const *px = read(x), *const *py = read(y);
  assign(z, [=](std::size_t k, std::size_t i) { return f(px[k][i], py[k][i]); });
}
template <auto f>
void of_one(N_Vector x, N_Vector z) {
  double* const* px = read(x);
  assign(z, [=](std::size_t k, std::size_t i) { return f(px[k][i]); });
}
void scale(double c, N_Vector x, N_Vector z) {
  if (c == 1.0) return copy(x, z);
  double* const* px = read(x);
  assign(z, [=](std::size_t k, std::size_t i) { return c * px[k][i]; });
}
void add_constant(N_Vector x, double b, N_Vector z) {
  double* const* px = read(x);
  assign(z, [=](std::size_t k, std::size_t i) { return px[k][i] + b; });
}

double dot_product(N_Vector x, N_Vector y) {
  double *const *px = read(x), *const *py = read(y);
  return sum(family_of(x), [=](std::size_t k, std::size_t i) { return px[k][i] * py[k][i]; });
}
double maximum_norm(N_Vector x) {
  double* const* px = read(x);
  return maximum(family_of(x), 0.0, [=](std::size_t k, std::size_t i) { return std::fabs(px[k][i]); });
}
double sum_of_weighted_squares(N_Vector x, N_Vector w) {
  double *const *px = read(x), *const *pw = read(w);
  return sum(family_of(x), [=](std::size_t k, std::size_t i) {
    const double weighted = px[k][i] * pw[k][i];
    return weighted * weighted;
  });
}
double weighted_rms_norm(N_Vector x, N_Vector w) {
  const auto length = static_cast<double>(global_length(x));
  return length == 0.0 ? 0.0 : std::sqrt(sum_of_weighted_squares(x, w) / length);
}
double minimum(N_Vector x) {
  double* const* px = read(x);
  return -maximum(family_of(x), -infinity, [=](std::size_t k, std::size_t i) { return -px[k][i]; });
}
double weighted_l2_norm(N_Vector x, N_Vector w) { return std::sqrt(sum_of_weighted_squares(x, w)); }

// z = c_0 X_0 + c_1 X_1 + …, added in this order; z may be one of the X. A vanishing
// coefficient reads nothing: Butcher tables have many, and a method whose last stage is the
// new state must give both the same bits.
int linear_combination(int count, double* c, N_Vector* x, N_Vector z) {
  std::vector<double> factor;
  std::vector<double* const*> from;
  for (int j = 0; j < count; ++j)
    if (c[j] != 0.0) {
      factor.push_back(c[j]);
      from.push_back(read(x[j]));
    }
  if (from.empty()) {
    set_constant(0.0, z);
    return 0;
  }
  const destination to = overwrite(z);
  over_blocks(family_of(z), [&](std::size_t k, std::size_t begin, std::size_t end) {
    double buffer[block_length];
    const std::size_t length = end - begin;
    const double c0 = factor[0];
    const double* x0 = from[0][k] + begin;
#pragma omp simd
    for (std::size_t i = 0; i < length; ++i) buffer[i] = c0 * x0[i];
    for (std::size_t j = 1; j < from.size(); ++j) {
      const double cj = factor[j];
      const double* xj = from[j][k] + begin;
#pragma omp simd
      for (std::size_t i = 0; i < length; ++i) buffer[i] += cj * xj[i];
    }
    std::copy_n(buffer, length, to.values[k] + begin);
  });
  return 0;
}
int dot_product_multi(int count, N_Vector x, N_Vector* y, double* results) {
  double* const* px = read(x);
  std::vector<double* const*> py;
  for (int j = 0; j < count; ++j) py.push_back(read(y[j]));
  sums(family_of(x), {results, py.size()},
       [&](std::size_t j, std::size_t k, std::size_t i) { return px[k][i] * py[j][k][i]; });
  return 0;
}

void fill_operations(_generic_N_Vector_Ops& ops) {
  ops.nvgetvectorid = vector_id;
  ops.nvclone = ops.nvcloneempty = clone;
  ops.nvdestroy = destroy;
  ops.nvgetcommunicator = communicator;
  ops.nvgetlength = global_length;
  ops.nvlinearsum = linear_sum;
  ops.nvconst = set_constant;
  ops.nvprod = of_two<[](double x, double y) { return x * y; }>;
  ops.nvdiv = of_two<[](double x, double y) { return x / y; }>;
  ops.nvscale = scale;
  ops.nvabs = of_one<[](double x) { return std::fabs(x); }>;
  ops.nvinv = of_one<[](double x) { return 1.0 / x; }>;
  ops.nvaddconst = add_constant;
  ops.nvdotprod = dot_product;
  ops.nvmaxnorm = maximum_norm;
  ops.nvwrmsnorm = weighted_rms_norm;
  ops.nvmin = minimum;
  ops.nvwl2norm = weighted_l2_norm;
  ops.nvlinearcombination = linear_combination;
  ops.nvdotprodmulti = dot_product_multi;
}

}  // namespace

vector_handle make_state_vector(SUNContext context, MPI_Comm communicator, const std::vector<state_field>& fields) {
  auto shared = std::make_shared<family>(family{communicator, fields.size(), {}, 0, 0, 0, {}});
  std::vector<double*> arrays;
  long long total = 0;
  for (const state_field& f : fields) {
    arrays.push_back(f.values);
    shared->n.push_back(f.n);
    shared->most = std::max(shared->most, f.n);
    total += static_cast<long long>(f.n);
  }
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_LONG_LONG, MPI_SUM, communicator);
  shared->global_length = static_cast<sunindextype>(total);

  vector_handle v(N_VNewEmpty(context));
  if (!v) throw std::bad_alloc();
  fill_operations(*v->ops);
  v->content = new content{std::move(shared), std::move(arrays), nullptr, true};
  return v;
}

std::span<const double* const> values(N_Vector v) {
  return {const_cast<const double* const*>(read(v)), family_of(v).fields};
}

std::span<double* const> values_to_overwrite(N_Vector v) { return {overwrite(v).values, family_of(v).fields}; }

void forget_values(N_Vector clone) { of(clone).stored.reset(); }

void home_was_changed(N_Vector home) { of(home).stored.reset(); }

void set_home_arrays(N_Vector home, std::vector<double*> fields) {
  of(home).home = std::move(fields);
  of(home).stored.reset();
}

bool holds_values_of(N_Vector home, N_Vector v) {
  return home == v || (of(home).stored && !of(v).is_home && of(home).stored == of(v).stored);
}

long long copies_made(N_Vector v) { return family_of(v).copies; }

}  // namespace tetsuame::integrators
