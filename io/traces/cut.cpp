#include "io/traces/cut.hpp"

#include "core/pipeline/segmenter.hpp"

namespace stickslip::traces {

std::vector<std::pair<std::size_t, std::size_t>> tests_in(
    const base::LongColumn<base::ScanIndex>& scan, const std::function<double(std::size_t)>& coefficient,
    double rate_Hz) {
  using Event = pipeline::Segmenter::Event;
  pipeline::SegmenterSettings settings;
  settings.scan_rate_Hz = rate_Hz;
  pipeline::Segmenter segmenter{settings};
  std::vector<std::size_t> cuts{0};
  std::size_t ended = 0;
  bool any = false;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    switch (segmenter.observe(scan[i], coefficient(i))) {
      case Event::kTestStarts:
        if (any) cuts.push_back(ended + (i - ended) / 2);
        any = true;
        break;
      case Event::kUnloaded:
      case Event::kNoRelativeMotion:
        ended = i;
        break;
      case Event::kNone:
      case Event::kPulledAgain:
      case Event::kNegative:
        break;
    }
  }
  cuts.push_back(scan.size());
  std::vector<std::pair<std::size_t, std::size_t>> tests;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) tests.emplace_back(cuts[i], cuts[i + 1]);
  return tests;
}

}  // namespace stickslip::traces
