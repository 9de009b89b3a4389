// SPDX-License-Identifier: MIT
// seqloop-street: makes drives down a street that does not exist.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "options.hpp"
#include "renderer.hpp"

namespace {

using namespace seqloop::street;

/// Atomic, because the system may give a signal to any thread: OpenCV's workers run too.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may write it");

void complain(const std::string& line) {
  std::fprintf(stderr, "seqloop-street: %s\n", line.c_str());
}

/// One line on a terminal that counts frames; nothing elsewhere.
class Progress {
 public:
  Progress(std::size_t total, bool quiet)
      : total_(total), shown_(!quiet && ::isatty(STDERR_FILENO) == 1) {}
  ~Progress() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step() {
    ++done_;
    if (!shown_ || (done_ % 10 != 0 && done_ != total_)) return;
    constexpr std::size_t kWide = 40;
    const std::string bar(done_ * kWide / total_, '#');
    std::fprintf(stderr, "\r[%-40s] %zu/%zu", bar.c_str(), done_, total_);
  }

 private:
  std::size_t total_;
  std::size_t done_ = 0;
  bool shown_;
};

void render_drive(const Drive& drive, const std::string& name, const Job& job,
                  const std::filesystem::path& folder, Progress& progress) {
  Renderer renderer(drive.path(), job.width, job.height);
  const auto sink = open_sink(folder, name, job.format, {job.width, job.height});
  cv::Mat image;
  for (std::size_t i = 0; i < drive.frames(); ++i) {
    if (interrupted) throw std::runtime_error("interrupted: nothing was kept");
    renderer.render(drive.shot(i), image);
    sink->put(image);
    progress.step();
  }
  sink->close();
}

int run(const Options& options, const Job& job) {
  if (options.keep && Staging::holds(options.out, job.parameters)) return 0;
  Staging staging(options.out);
  const std::filesystem::path& folder = staging.folder();
  const Street street(job.seed);
  if (job.drives == Drives::localise) {
    Progress progress(2 * job.frames, options.quiet);
    const Drive reference(street, localise_plan(job, false));
    const Drive query(street, localise_plan(job, true));
    render_drive(reference, "reference", job, folder, progress);
    render_drive(query, "query", job, folder, progress);
    write_truth(folder / "truth.csv", localise_truth(query, reference));
    write_poses(folder / "reference.csv", reference);
    write_poses(folder / "query.csv", query);
  } else {
    Progress progress(job.frames, options.quiet);
    const Drive drive(street, loop_plan(job));
    render_drive(drive, "drive", job, folder, progress);
    write_truth(folder / "truth.csv", loop_truth(drive));
    constexpr double kNear = 10.0;  // metres
    write_near(folder / "near.csv", near_truth(drive, kNear));
    write_poses(folder / "drive.csv", drive);
  }
  staging.commit(job.parameters);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Makes drives down a street that does not exist, to close loops on."};
  Options o;
  app.add_option("--out", o.out, "folder to make")->type_name("DIR");
  app.add_option("--frames", o.frames, "frames of each drive [300]")->type_name("N");
  app.add_option("--seed", o.seed, "chooses the street and the drives [1]")->type_name("S");
  app.add_option("--drives", o.drives,
                 "localise: one street driven twice; loop: one drive that "
                 "comes back to its own places [localise]")
      ->type_name("localise|loop");
  app.add_option("--size", o.size, "pixels [320x180]")->type_name("WxH");
  app.add_option("--format", o.format, "image folders, or one video each [jpg]")
      ->type_name("jpg|png|avi");
  app.add_option("--length", o.length, "length of a drive [a metre a frame]")->type_name("METRES");
  app.add_option("--kidnaps", o.kidnaps, "loop: times the camera is put elsewhere [0]")
      ->type_name("K");
  app.add_option("--first-light", o.first_light,
                 "of the reference, or of the start of a loop drive [summer]")
      ->type_name(light_names());
  app.add_option("--second-light", o.second_light,
                 "of the query [winter], or towards which a loop drive goes [evening]")
      ->type_name(light_names());
  app.add_flag("--keep", o.keep, "do nothing if DIR was made with the same parameters");
  app.add_flag("--quiet", o.quiet, "no progress bar");
  app.set_version_flag("--version", "seqloop-street " SEQLOOP_VERSION, "print the version");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    complain(std::string("command line: ") + error.what() + "; see seqloop-street --help");
    return 2;
  }
  std::vector<std::string> faults;
  const std::optional<Job> job = check(o, faults);
  for (const std::string& fault : faults) complain(fault);
  if (!job) return 2;
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  const auto interrupt = [](int) { interrupted = true; };
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  try {
    return run(o, *job);
  } catch (const std::exception& error) {
    complain(error.what());
    return 1;
  }
}
