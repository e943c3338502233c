// What runs with grains are judged by: a single impact, a heap, a discharge.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <dem/contacts.hpp>
#include <domain/communicator.hpp>
#include <granular/options.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <output/checkpoint.hpp>
#include <vector>

namespace tetsuame::granular {

// The largest overlap and normal force of a run; of one grain, or two, when they touch for the first time.
class contact_record {
 public:
  // After a step that ended at t. single: the numbers of `now` are those of all ranks.
  void add(const dem::contact_measures& now, double t, bool single) {
    deepest_ = std::max(deepest_, now.overlap);
    strongest_ = std::max(strongest_, now.force);
    if (!single || left_ >= 0.0) return;
    if (now.any) {
      if (entered_ < 0.0) {
        entered_ = now.approach > 0.0 ? t - now.overlap / now.approach : t;
        normal_ = now.normal;
      }
      last_ = {t, now.overlap, now.approach};
    } else if (entered_ >= 0.0) {
      left_ = last_[1] > 0.0 && last_[2] < 0.0 ? std::min(t, last_[0] - last_[1] / last_[2]) : t;
    }
  }
  void report(const domain::communicator& ranks, nlohmann::ordered_json& m) const {
    m["delta_max"] = ranks.maximum(deepest_);
    m["force_max"] = ranks.maximum(strongest_);
    m["contact_time"] = left_ >= 0.0 ? nlohmann::ordered_json(left_ - entered_) : nullptr;
  }
  // From the partner to the grain, of the first contact; none: there was none.
  std::optional<std::array<double, 3>> normal() const { return left_ >= 0.0 ? std::optional(normal_) : std::nullopt; }

  void save(const domain::communicator& ranks, output::checkpoint_globals& g) const {
    g.blobs["contact_record"] = {ranks.maximum(deepest_),
                                 ranks.maximum(strongest_),
                                 entered_,
                                 left_,
                                 last_[0],
                                 last_[1],
                                 last_[2],
                                 normal_[0],
                                 normal_[1],
                                 normal_[2]};
  }
  void restore(const output::checkpoint_globals& g) {
    const auto& b = g.blobs.at("contact_record");
    deepest_ = b[0];
    strongest_ = b[1];
    entered_ = b[2];
    left_ = b[3];
    std::copy_n(b.begin() + 4, 3, last_.begin());
    std::copy_n(b.begin() + 7, 3, normal_.begin());
  }

 private:
  double deepest_ = 0.0, strongest_ = 0.0, entered_ = -1.0, left_ = -1.0;  // m, N, s
  std::array<double, 3> last_{};                                           // s, m, m/s: of the last step in contact
  std::array<double, 3> normal_{};
};

// The surface of a heap over x: the highest point of grains in columns.
class heap_profile {
 public:
  heap_profile(double length, double width)
      : width_(width), top_(static_cast<std::size_t>(std::max(1.0, std::ceil(length / width))), 0.0) {}

  // heaped: it lies on, or beneath, another grain; run_out() is of those.
  void add(double x, double y, double radius, bool heaped) {
    const double n = std::floor(x / width_);
    if (n >= 0.0 && n < static_cast<double>(top_.size())) {
      auto& top = top_[static_cast<std::size_t>(n)];
      top = std::max(top, y + radius);
    }
    if (heaped) run_out_ = std::max(run_out_, x + radius);
  }
  void share(const domain::communicator& ranks) {
    ranks.maximum(top_);
    run_out_ = ranks.maximum(run_out_);
  }
  double run_out() const { return run_out_; }  // m, the largest x of one

  struct line {
    double angle, error;  // degrees; standard error
  };
  // By least squares through the columns beyond the highest one, between a tenth and four fifths of its height.
  std::optional<line> slope() const {
    const auto peak = static_cast<std::size_t>(std::max_element(top_.begin(), top_.end()) - top_.begin());
    std::vector<std::array<double, 2>> points;
    for (std::size_t n = peak; n < top_.size(); ++n) {
      if (top_[n] < 0.1 * top_[peak]) break;
      if (top_[n] < 0.8 * top_[peak]) points.push_back({(static_cast<double>(n) + 0.5) * width_, top_[n]});
    }
    const auto n = static_cast<double>(points.size());
    if (points.size() < 4) return {};
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (const auto& p : points) {
      x += p[0] / n;
      y += p[1] / n;
    }
    for (const auto& p : points) {
      xx += (p[0] - x) * (p[0] - x);
      xy += (p[0] - x) * (p[1] - y);
      yy += (p[1] - y) * (p[1] - y);
    }
    const double a = xy / xx, left = std::max(0.0, yy - a * xy) / (n - 2.0);
    constexpr double degrees = 57.29577951308232;
    return line{std::atan(-a) * degrees, std::sqrt(left / xx) / (1.0 + a * a) * degrees};
  }

 private:
  double width_;  // m
  std::vector<double> top_;
  double run_out_ = 0.0;
};

// Mass that has fallen below a height, by lines of the history.
class discharge {
 public:
  void add(double t, double mass) {
    if (!t_.empty() && t <= t_.back()) return;
    t_.push_back(t);
    mass_.push_back(mass);
  }
  // kg/s, by least squares while a tenth to six tenths of what came out in the end do.
  std::optional<double> rate() const {
    double n = 0.0, t = 0.0, m = 0.0, tt = 0.0, tm = 0.0;
    if (mass_.empty() || !(mass_.back() > 0.0)) return {};
    const auto counts = [&](std::size_t k) { return mass_[k] > 0.1 * mass_.back() && mass_[k] < 0.6 * mass_.back(); };
    for (std::size_t k = 0; k < t_.size(); ++k)
      if (counts(k)) {
        n += 1.0;
        t += t_[k];
        m += mass_[k];
      }
    if (n < 5.0) return {};
    for (std::size_t k = 0; k < t_.size(); ++k)
      if (counts(k)) {
        tt += (t_[k] - t / n) * (t_[k] - t / n);
        tm += (t_[k] - t / n) * (mass_[k] - m / n);
      }
    return tm / tt;
  }
  void save(output::checkpoint_globals& g) const {
    g.blobs["discharge_time"] = t_;
    g.blobs["discharge_mass"] = mass_;
  }
  void restore(const output::checkpoint_globals& g) {
    t_ = g.blobs.at("discharge_time");
    mass_ = g.blobs.at("discharge_mass");
  }

 private:
  std::vector<double> t_, mass_;  // s, kg
};

}  // namespace tetsuame::granular
