#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <output/agree.hpp>
#include <output/log.hpp>

namespace tetsuame::output {

run_log::run_log(MPI_Comm comm, const std::string& path) {
  on_rank_0(comm, [&] {
    file_ = append_to(path);
    const auto line =
        fmt::format("--- {:%Y-%m-%d %H:%M:%S} UTC, {} ranks\n", fmt::gmtime(std::time(nullptr)), size_of(comm));
    std::fputs(line.c_str(), file_.get());
    std::fflush(file_.get());
  });
}

void run_log::write(const std::string& text) {
  if (!file_) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  const auto line = fmt::format("{:10.2f} s  {}\n", elapsed.count(), text);
  std::fwrite(line.data(), 1, line.size(), file_.get());
  std::fflush(file_.get());
}

}  // namespace tetsuame::output
