/// \file
/// The daemon as one of many at a broker: state, health and results of its tests go there (docs/fleet.md).
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/base/clock.hpp"
#include "core/pipeline/sink.hpp"
#include "core/record/record.hpp"
#include "daemon/fleet/publisher.hpp"
#include "daemon/types/facts.hpp"
#include "daemon/types/status.hpp"

namespace stickslip::fleet {

/// Bound to the main thread, but for what says otherwise. As a sink it is of the processing thread and only
/// posts.
class Fleet final : public pipeline::Sink {
 public:
  struct Parts {
    std::function<daemon::Status()> status;
    const base::Clock& wall;
    daemon::Facts& facts;
    std::filesystem::path record_folder;
    std::string program;  ///< Of backlog.hpp.
  };
  /// After the records of a former program have been recovered, before a test can end.
  Fleet(boost::asio::io_context& io, const io::FleetSettings& settings, Parts parts);

  /// The storage thread: a test is over.
  void test_recorded(const record::RecordHeader& header, const record::EndRecord& end,
                     const std::filesystem::path& file);
  /// The status may be another.
  void state_changed();
  void bench_changed(pipeline::BenchState state) override;

  [[nodiscard]] daemon::FleetState state() const { return publisher_.state(); }
  /// The last words; at most two seconds.
  void stop();

 private:
  [[nodiscard]] FleetPublisher::World world(std::vector<std::filesystem::path> untold);
  void link_changed(const daemon::FleetState& state);
  void tick();

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
  io::FleetSettings settings_;
  Parts parts_;
  std::string told_;                     ///< The latest state, without its time.
  std::atomic<bool> on_the_way_{false};  ///< A word of the bench to the main thread.
  bool was_connected_ = false;           ///< Thread of the publisher, as the next.
  std::string why_told_;
  FleetPublisher publisher_;
};

}  // namespace stickslip::fleet
