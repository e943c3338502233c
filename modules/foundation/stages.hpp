// Where the time goes: a step is a list of named stages, each with the seconds spent in it
// and not in a stage inside it.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace tetsuame::foundation {

class stage_times {
 public:
  void enter(const char* name) {
    charge();
    open_.push_back(name);
  }
  void leave() {
    charge();
    open_.pop_back();
  }
  const std::map<std::string, double>& seconds() const { return seconds_; }
  void clear() { seconds_.clear(); }

 private:
  using clock = std::chrono::steady_clock;
  void charge() {
    const auto now = clock::now();
    if (!open_.empty()) seconds_[open_.back()] += std::chrono::duration<double>(now - since_).count();
    since_ = now;
  }

  std::map<std::string, double> seconds_;
  std::vector<const char*> open_;
  clock::time_point since_ = clock::now();
};

// A stage lasts as long as this lives.
class stage {
 public:
  stage(stage_times& times, const char* name) : times_(times) { times_.enter(name); }
  ~stage() { times_.leave(); }
  stage(const stage&) = delete;
  stage& operator=(const stage&) = delete;

 private:
  stage_times& times_;
};

}  // namespace tetsuame::foundation
