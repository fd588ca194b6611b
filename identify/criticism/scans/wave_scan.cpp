#include "volcal/identify/criticism/scans/wave_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

constexpr int kDirections = 3;
constexpr double kBin = kFinestWave / 2.0;
constexpr std::size_t kPadding = 2;  // half a period over the range between neighbouring frequencies
constexpr std::size_t kPeaks = 3;    // that are projected
constexpr int kRefined = 4;          // steps between neighbouring frequencies
constexpr int kCosineAndSine = 2;
constexpr double kLargestWave = 1e-2;  // m

using Spectrum = std::vector<std::complex<double>>;

/// What an axis' positions allow to be looked for.
struct Band {
  double low = 0.0;        ///< m, the lowest position
  double range = 0.0;      ///< m
  double deviation = 0.0;  ///< m, standard deviation
  std::size_t bins = 0;

  double step() const { return 1.0 / (static_cast<double>(bins) * kBin); }  ///< 1/m
  std::size_t first() const { return static_cast<std::size_t>(std::ceil(lowest() / step())); }
  std::size_t last() const {
    return std::min(bins - 1, static_cast<std::size_t>(1.0 / (kFinestWave * step())));
  }
  double lowest() const { return kWavesOfKernels / range; }
  /// Does the axis move far enough for any period?
  bool is_open() const { return range > kWavesOfKernels * kFinestWave && first() < last(); }
};

Eigen::VectorXd positions(const LinearModel& model, AxisName axis) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(model.size()));
  for (std::size_t i = 0; i < model.size(); ++i) {
    const auto& [setup, row, channel] = model.observations()[i];
    q[static_cast<Eigen::Index>(i)] = model.campaign().setups[setup].readings.position[index_of(axis)][row];
  }
  return q;
}

Band band_of(const Eigen::VectorXd& q) {
  Band band;
  band.low = q.minCoeff();
  band.range = q.maxCoeff() - band.low;
  band.deviation = std::sqrt((q.array() - q.mean()).square().mean());
  band.bins = std::bit_ceil(kPadding * static_cast<std::size_t>(band.range / kBin + 1.0));
  return band;
}

/// Two real columns at once: the real and the imaginary part.
Spectrum transformed(Eigen::FFT<double>& fft, const Eigen::VectorXd& q, const Band& band,
                     const Eigen::VectorXd& real, const Eigen::VectorXd& imaginary) {
  Spectrum binned(band.bins), spectrum;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    binned[static_cast<std::size_t>((q[i] - band.low) / kBin)] += std::complex(real[i], imaginary[i]);
  fft.fwd(spectrum, binned);
  return spectrum;
}

/// |s|^2 of the real column (of the imaginary one) by the symmetry of spectra of real columns.
double power(const Spectrum& spectrum, std::size_t k, bool of_imaginary) {
  const std::complex<double> at = spectrum[k], mirrored = std::conj(spectrum[spectrum.size() - k]);
  return 0.25 * std::norm(of_imaginary ? at - mirrored : at + mirrored);
}

/// The largest local maxima, largest first.
std::vector<std::size_t> peaks(const Spectrum& spectrum, const Band& band, bool of_imaginary) {
  std::vector<std::pair<double, std::size_t>> found;
  double before = 0.0, here = power(spectrum, band.first(), of_imaginary);
  for (std::size_t k = band.first(); k <= band.last(); ++k) {
    const double after = k < band.last() ? power(spectrum, k + 1, of_imaginary) : 0.0;
    if (here > before && here >= after) {
      found.emplace_back(here, k);
      std::ranges::push_heap(found, std::greater{});
      if (found.size() > kPeaks) {
        std::ranges::pop_heap(found, std::greater{});
        found.pop_back();
      }
    }
    before = here;
    here = after;
  }
  std::ranges::sort(found, std::greater{});
  std::vector<std::size_t> frequencies;
  for (const auto& [height, k] : found) frequencies.push_back(k);
  return frequencies;
}

double mean_power(const Spectrum& spectrum, const Band& band, bool of_imaginary) {
  double sum = 0.0;
  for (std::size_t k = band.first(); k <= band.last(); ++k) sum += power(spectrum, k, of_imaginary);
  return sum / static_cast<double>(band.last() - band.first() + 1);
}

Eigen::MatrixXd wave(const Eigen::VectorXd& q, const Eigen::VectorXd& along, double frequency) {
  const Eigen::ArrayXd phase = q.array() * (2.0 * std::numbers::pi * frequency);
  Eigen::MatrixXd columns(q.size(), 2);
  columns << phase.cos() * along.array(), phase.sin() * along.array();
  return columns;
}

/// Frequencies about the peaks, projected together.
std::vector<double> frequencies_about(const std::vector<std::size_t>& peaks, const Band& band) {
  std::vector<double> frequencies;
  for (const std::size_t peak : peaks) {
    for (int k = -kRefined; k <= kRefined; ++k) {
      const double frequency = band.step() * (static_cast<double>(peak) + static_cast<double>(k) / kRefined);
      if (frequency >= band.lowest()) frequencies.push_back(frequency);
    }
  }
  return frequencies;
}

double log10_choices(const Band& band, double lm) {
  const double width =
      (1.0 / kFinestWave - band.lowest()) * std::sqrt(4.0 * std::numbers::pi) * band.deviation;
  return std::max(0.0, std::log10(width) + 0.5 * std::log10(0.5 * lm));
}

WaveTest best_wave(const Projector& projector, const Eigen::VectorXd& q, const Eigen::VectorXd& along,
                   const Band& band, const std::vector<std::size_t>& peaks, double mean_power) {
  WaveTest best;
  const std::vector<double> frequencies = frequencies_about(peaks, band);
  const auto count = static_cast<Eigen::Index>(frequencies.size());
  if (count == 0) return best;
  Eigen::MatrixXd columns(q.size(), 2 * count);
  for (Eigen::Index k = 0; k < count; ++k)
    columns.middleCols(2 * k, 2) = wave(q, along, frequencies[static_cast<std::size_t>(k)]);
  const ProjectedColumns projected = projector.project(columns);
  const double by_noise = 2.0 * projected.grams.front().diagonal().mean();  // of the power
  const double inflation = std::max(1.0, mean_power / by_noise);
  for (Eigen::Index k = 0; k < count; ++k) {
    const ScoreTest test = score_test(projected, kCosineAndSine * k, kCosineAndSine,
                                      Eigen::VectorXd::Constant(kCosineAndSine, kLargestWave));
    const double lm = test.lm / inflation;
    if (test.dof < kCosineAndSine || lm <= best.lm) continue;
    best.period = 1.0 / frequencies[static_cast<std::size_t>(k)];
    best.lm = lm;
    best.projected_lm = test.lm;
    best.dof = test.dof;
    best.log10_choices = log10_choices(band, lm);
    best.log10_p =
        std::min(0.0, log10_chi_squared_exceedance(lm, static_cast<double>(test.dof)) + best.log10_choices);
  }
  return best;
}

}  // namespace

std::vector<WaveTest> wave_scan(const LinearModel& model, const Projector& projector, int threads) {
  const Eigen::VectorXd weighed = projector.weighed_residual();
  Eigen::MatrixXd along(weighed.size(), kDirections);
  for (int k = 0; k < kDirections; ++k)
    along.col(k) = model.direction(kScanDirections[static_cast<std::size_t>(k)]);
  const Eigen::MatrixXd score = along.array().colwise() * weighed.array();
  std::vector<AxisName> axes;
  for (const Axis& axis : model.campaign().machine.axes) {
    if (!is_rotary(axis.name)) axes.push_back(axis.name);
  }
  std::erase_if(axes, [&](AxisName axis) { return !band_of(positions(model, axis)).is_open(); });
  std::vector<WaveTest> tests(axes.size() * kDirections);
  run_parallel(axes.size(), threads, [&](std::size_t i) {
    const Eigen::VectorXd q = positions(model, axes[i]);
    const Band band = band_of(q);
    Eigen::FFT<double> fft;
    const Spectrum xy = transformed(fft, q, band, score.col(0), score.col(1));
    const Spectrum z = transformed(fft, q, band, score.col(2), Eigen::VectorXd::Zero(q.size()));
    for (int direction = 0; direction < kDirections; ++direction) {
      WaveTest& test = tests[i * kDirections + static_cast<std::size_t>(direction)];
      const bool of_imaginary = direction == 1;
      const Spectrum& spectrum = direction == 2 ? z : xy;
      test = best_wave(projector, q, along.col(direction), band, peaks(spectrum, band, of_imaginary),
                       mean_power(spectrum, band, of_imaginary));
      test.axis = axes[i];
      test.direction = kScanDirections[static_cast<std::size_t>(direction)];
    }
  });
  return tests;
}

Eigen::MatrixXd wave_columns(const LinearModel& model, AxisName axis, ScanDirection direction,
                             double period) {
  return wave(positions(model, axis), model.direction(direction), 1.0 / period);
}

}  // namespace volcal
