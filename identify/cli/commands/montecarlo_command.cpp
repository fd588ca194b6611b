#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/draw_ranks.h"
#include "volcal/identify/cli/interrupt_watch.h"
#include "volcal/identify/cli/options/conditions_options.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/criticism/screening.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/checkpoint_file.h"
#include "volcal/identify/io/results/montecarlo_writer.h"
#include "volcal/identify/montecarlo/disturbance.h"
#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/montecarlo_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/fit_words.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct MonteCarloArguments {
  std::string campaign;
  std::string model;
  std::string output;
  std::string path = "auto";
  std::string functions = "drawn";
  std::string outliers = "list";
  std::string noise = "auto";
  std::vector<std::string> disturbances;
  MonteCarloOptions options;
  ConditionsArguments conditions;
  double checkpoint_s = 10.0;
  double minutes = 10.0;
  bool resume = false;
  bool json = false;
};

/// Of the ranks that share the draws.
bool is_first(const MonteCarloArguments& arguments) {
  return arguments.options.team == nullptr || arguments.options.team->rank() == 0;
}

FitResult fitted(const MonteCarloArguments& arguments, const Campaign& campaign, ProgressBar& bar) {
  const ModelSpec model =
      arguments.model.empty() ? ModelSpec{} : read_model(arguments.model, campaign.machine);
  FitOptions options;
  options.threads = arguments.options.threads;
  options.outliers = outlier_policy(arguments.outliers);
  options.noise = noise_policy(arguments.noise);
  options.progress = [&bar](const std::string& stage, double done) { bar.update("fit: " + stage, done); };
  FitResult result = fit(campaign, model, options);
  if (is_first(arguments)) screen_fit(campaign, options, result);
  return result;
}

std::string checkpoint_path(const MonteCarloArguments& arguments) {
  std::string path = arguments.output;
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path + ".checkpoint";
}

/// Reports draws, their rate and the time that is left.
class DrawProgress {
 public:
  DrawProgress(ProgressBar& bar, const MonteCarloStudy& study) : bar_(bar), before_(study.draws()) {}

  void update(const MonteCarloStudy& study) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const double rate = static_cast<double>(study.draws() - before_) / std::max(seconds, 1e-9);
    const std::uint64_t expected = study.expected_draws();
    std::string stage = fmt::format("{} draws, {}/s", count_number(static_cast<long long>(study.draws())),
                                    count_number(static_cast<long long>(rate)));
    if (expected > 0 && rate > 0.0) {
      stage += fmt::format(" of {}, {:.0f} s left", count_number(static_cast<long long>(expected)),
                           static_cast<double>(expected - std::min(expected, study.draws())) / rate);
    }
    bar_.update(stage, expected > 0
                           ? std::min(1.0, static_cast<double>(study.draws()) / static_cast<double>(expected))
                           : 0.0);
  }

 private:
  using Clock = std::chrono::steady_clock;
  ProgressBar& bar_;
  std::uint64_t before_;
  Clock::time_point start_ = Clock::now();
};

void require_no_checkpoint(const std::string& checkpoint) {
  if (!has_checkpoint(checkpoint)) return;
  throw InputError({checkpoint, 0}, "an interrupted study of this output folder is kept here",
                   "give --resume to go on with it, or delete the file to begin anew");
}

/// Throws InputError for a checkpoint that cannot be this study's.
void restore(const std::string& checkpoint, MonteCarloStudy& study) {
  const std::string state = read_checkpoint(checkpoint, study.fingerprint());
  try {
    study.restore(state);
  } catch (const std::invalid_argument& problem) {
    throw InputError({checkpoint, 0}, std::string("the checkpoint cannot be read: ") + problem.what(),
                     "delete it, and leave --resume out to begin anew");
  }
}

void require_draws_left(const MonteCarloArguments& arguments, const std::string& checkpoint,
                        const MonteCarloStudy& study) {
  if (arguments.options.draws == 0 || study.draws() <= arguments.options.draws) return;
  throw InputError({checkpoint, 0},
                   fmt::format("the interrupted study has {} draws, more than the {} asked for",
                               study.draws(), arguments.options.draws),
                   "give -n as before or larger");
}

/// Why drawing ended.
enum class End { Done, OutOfTime, Interrupted };

/// The first rank's word holds for all.
End agreed(const MonteCarloArguments& arguments, End own) {
  if (arguments.options.team == nullptr) return own;
  const std::string first = arguments.options.team->gather(std::to_string(static_cast<int>(own))).front();
  return static_cast<End>(std::stoi(first));
}

/// Every rank draws; the first reports and keeps checkpoints.
End draw_all(const MonteCarloArguments& arguments, ProgressBar& bar, MonteCarloStudy& study) {
  using Clock = std::chrono::steady_clock;
  const std::string checkpoint = checkpoint_path(arguments);
  const bool has_a_limit = arguments.options.draws == 0 && arguments.minutes > 0.0;
  DrawProgress progress(bar, study);
  const InterruptWatch interrupt("\nending after this block of draws; Ctrl-C again ends at once\n");
  const Clock::time_point start = Clock::now();
  Clock::time_point kept = start;
  if (is_first(arguments)) progress.update(study);
  while (!study.done()) {
    study.run_block();
    const double minutes = std::chrono::duration<double>(Clock::now() - start).count() / kSecondsPerMinute;
    const End end = agreed(arguments, interrupt.was_asked_for()                    ? End::Interrupted
                                      : has_a_limit && minutes > arguments.minutes ? End::OutOfTime
                                                                                   : End::Done);
    if (end != End::Done) {
      if (is_first(arguments)) write_checkpoint(checkpoint, study.fingerprint(), study.save());
      return end;
    }
    if (!is_first(arguments)) continue;
    progress.update(study);
    if (std::chrono::duration<double>(Clock::now() - kept).count() < arguments.checkpoint_s) continue;
    write_checkpoint(checkpoint, study.fingerprint(), study.save());
    kept = Clock::now();
  }
  return End::Done;
}

void write_study(const MonteCarloArguments& arguments, const std::string& json,
                 const MonteCarloResult& result, const Machine& machine) {
  AtomicFolder folder(arguments.output);
  folder.write("montecarlo.json", json);
  folder.write("montecarlo.csv", montecarlo_csv(result));
  folder.write("montecarlo.txt", montecarlo_text(result));
  if (report_available()) folder.write("report.html", report_html(result, machine, report_options()));
  folder.commit();
}

struct Drawn {
  MonteCarloResult result;
  End end = End::Done;
};

MonteCarloOptions study_options(const MonteCarloArguments& arguments, const Campaign& campaign) {
  MonteCarloOptions options = arguments.options;
  options.path = draw_path(arguments.path);
  options.sources.functions = function_roughness(arguments.functions);
  for (const std::string& text : arguments.disturbances)
    options.sources.disturbances.push_back(disturbance_from(text, campaign));
  return options;
}

Drawn drawn(const MonteCarloArguments& arguments, const Campaign& campaign, const FitResult& fit_result,
            const MonteCarloOptions& options, ProgressBar& bar) {
  bar.update("refits", 0.0);
  MonteCarloStudy study(campaign, fit_result, options);
  const std::string checkpoint = checkpoint_path(arguments);
  if (arguments.resume) restore(checkpoint, study);
  require_draws_left(arguments, checkpoint, study);
  const End end = draw_all(arguments, bar, study);
  bar.finish();
  Drawn drawn{study.result(), end};
  drawn.result.notes = campaign.notes;
  return drawn;
}

/// What was drawn so far is kept.
int tell_interrupted(const MonteCarloArguments& arguments, const MonteCarloResult& result) {
  if (is_first(arguments)) {
    fmt::print(stderr, "interrupted after {} draws, which {} keeps; the same command with --resume goes on\n",
               count_number(static_cast<long long>(result.draws)), checkpoint_path(arguments));
  }
  return kIncomplete;
}

/// Ends as fit does, and writes nothing.
int tell_undetermined(const MonteCarloArguments& arguments, const FitResult& fit_result,
                      const std::vector<Finding>& notes) {
  if (is_first(arguments))
    fmt::print("{}", arguments.json ? undetermined_json(fit_result, notes)
                                    : undetermined_text(fit_result) + findings_text(notes));
  return kIncomplete;
}

int run_montecarlo(MonteCarloArguments arguments) {
  const std::unique_ptr<DrawTeam> ranks = draw_ranks();
  arguments.options.team = ranks.get();
  require_output_folder(arguments.output, {arguments.campaign, arguments.model});
  if (!arguments.resume) require_no_checkpoint(checkpoint_path(arguments));
  const Campaign campaign = read_campaign(arguments.campaign);
  require_known_conditions(campaign, arguments.conditions);
  MonteCarloOptions options = study_options(arguments, campaign);
  ProgressBar bar("montecarlo");
  const FitResult fit_result = fitted(arguments, campaign, bar);
  if (fit_result.status == FitStatus::RankDeficient) {
    bar.finish();
    return tell_undetermined(arguments, fit_result, campaign.notes);
  }
  if (!arguments.conditions.given.empty())
    options.conditions = conditions_of(fit_result, arguments.conditions);
  if (arguments.conditions.no_extrapolation)
    require_within_readings(fit_result, conditions_of(fit_result, arguments.conditions));
  const auto [result, end] = drawn(arguments, campaign, fit_result, options, bar);
  if (end == End::Interrupted) return tell_interrupted(arguments, result);
  const bool complete = fit_result.status != FitStatus::NotConverged && result.not_converged == 0 &&
                        (!result.adaptive || result.settled);
  const int exit_code = complete ? kDone : kIncomplete;
  if (!is_first(arguments)) return exit_code;
  const std::string json = montecarlo_json(result);
  write_study(arguments, json, result, campaign.machine);
  if (end == End::Done) remove_checkpoint(checkpoint_path(arguments));
  if (arguments.json) {
    fmt::print("{}", json);
  } else {
    fmt::print("{}\nwritten: {}\n", montecarlo_text(result), arguments.output);
  }
  return exit_code;
}

void define_draws(CLI::App& app, MonteCarloOptions& options) {
  app.add_option("-n,--draws", options.draws,
                 "draws; 0 = until --digits of every uncertainty are right (GUM Supplement 1, 7.9)")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--digits", options.digits, "significant digits of every uncertainty that shall be right")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  app.add_option("--most-draws", options.most_draws, "of a study without --draws; exit 1 when it ends here")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the random numbers; the same seed gives the same bits")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--threads", options.threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_option("--refits", options.refits, "sample of draws on which the paths are held to full refits")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--grid", options.grid_per_axis,
                 "points per linear axis whose errors are listed; 0 = nothing of the volume")
      ->check(CLI::Range(0, 11))
      ->capture_default_str();
}

std::function<int()> define_montecarlo(CLI::App& app) {
  auto arguments = std::make_shared<MonteCarloArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml")->required();
  app.add_option("-m,--model", arguments->model,
                 "model.toml; default: all 21 errors, cubic B-splines, automatic knots");
  app.add_option("-o,--output", arguments->output,
                 "folder for montecarlo.json, .csv, .txt and report.html; an interrupted study is kept in "
                 "OUTPUT.checkpoint")
      ->required();
  define_draws(app, arguments->options);
  app.add_option(
         "--path", arguments->path,
         "linear: one matrix product; chord: steps with an exact gradient, the transforms' second order "
         "held at the identified machine; refit: the adjustment run again; auto: the fastest that agrees "
         "with the sample of refits")
      ->check(CLI::IsMember({"auto", "linear", "chord", "refit"}));
  app.add_option("--functions", arguments->functions,
                 "drawn: what smoothing says of the functions is drawn too, u as in the tables; fixed: "
                 "campaigns repeated on the identified machine, scatter and the bias of smoothing apart")
      ->check(CLI::IsMember({"drawn", "fixed"}));
  app.add_option(
         "--disturb", arguments->disturbances,
         "KIND:TARGET=U or KIND:TARGET=+-A: an effect of the catalogue that acts on the readings and "
         "that the fit knows nothing of, of standard uncertainty U or within limits A; may be repeated")
      ->allow_extra_args(false);
  add_conditions_options(app, arguments->conditions);
  app.add_option("--outliers", arguments->outliers, "of the fit: list or remove flagged readings")
      ->check(one_of(kOutlierWords));
  app.add_option("--noise", arguments->noise, "of the fit: auto or white")->check(one_of(kNoiseWords));
  app.add_option("--minutes", arguments->minutes,
                 "of drawing, of a study without --draws: it ends with what it has reached, exit 1, and "
                 "--resume goes on; 0 = no limit")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--checkpoint-every", arguments->checkpoint_s, "seconds between checkpoints")
      ->check(not_negative())
      ->capture_default_str();
  app.add_flag("--resume", arguments->resume, "go on from the checkpoint of an interrupted run");
  app.add_flag("--json", arguments->json, "print montecarlo.json on standard output and nothing else");
  return [arguments] { return run_montecarlo(*arguments); };
}

}  // namespace

const Command& montecarlo_command() {
  static const Command command = {
      "montecarlo", "distributions of every error by drawing the campaign again",
      "  volcal montecarlo campaign.toml -o uncertainty\n"
      "  volcal montecarlo campaign.toml --model model.toml --path chord -n 100000 --seed 7 -o uncertainty\n"
      "  volcal montecarlo campaign.toml -n 100000 --functions fixed -o scatter\n"
      "  volcal montecarlo campaign.toml --conditions T_air=24,time_s=3600 -o warm\n"
      "  volcal montecarlo campaign.toml --disturb \"station-drift:station P1=0.5\" -o drifting\n"
      "  volcal montecarlo campaign.toml -o uncertainty --resume\n"
      "  mpirun -n 4 volcal montecarlo campaign.toml -n 1000000 --threads 8 -o uncertainty\n",
      define_montecarlo};
  return command;
}

}  // namespace volcal::cli
