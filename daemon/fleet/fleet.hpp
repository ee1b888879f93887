/// \file
/// Connects the daemon to an MQTT broker: sends it state, health and results of tests, and takes facts of
/// tests from it (docs/fleet.md).
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/base/clock.hpp"
#include "core/pipeline/sink.hpp"
#include "core/record/record.hpp"
#include "daemon/fleet/publisher.hpp"
#include "daemon/fleet/told_facts.hpp"
#include "daemon/types/event_receiver.hpp"
#include "daemon/types/status.hpp"

namespace stickslip::fleet {

/// Main thread, unless stated otherwise. bench_changed() runs on the processing thread and only posts to the
/// main thread.
class Fleet final : public pipeline::Sink {
 public:
  struct Parts {
    std::function<daemon::Status()> status;
    const base::Clock& wall;
    daemon::EventReceiver& events;
    std::filesystem::path record_folder;
    std::string program;           ///< Path of stickslipd, for backlog.hpp.
    ToldFacts::Changed set_facts;  ///< Takes facts of the tests to come.
  };
  /// Starts the publisher's thread. Call it after recovery and before a test can end.
  Fleet(boost::asio::io_context& io, const io::FleetSettings& settings, Parts parts);

  /// Queues the result of an ended test. Storage thread; does not block.
  void test_recorded(const record::RecordHeader& header, const record::EndRecord& end,
                     const std::filesystem::path& file);
  /// Sends the state if it has changed.
  void state_changed();
  void bench_changed(pipeline::BenchState state) override;

  [[nodiscard]] daemon::FleetState state() const { return publisher_.state(); }
  /// Sends the state "stopped" and the waiting results, then disconnects; blocks, as FleetPublisher::stop().
  void stop();

 private:
  [[nodiscard]] FleetPublisher::World world(std::vector<std::filesystem::path> untold);
  void link_changed(const daemon::FleetState& state);
  void tick();

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
  io::FleetSettings settings_;
  Parts parts_;
  std::string told_;                     ///< The state sent last, without its time.
  std::atomic<bool> on_the_way_{false};  ///< A call of state_changed() is posted.
  bool was_connected_ = false;           ///< Publisher's thread, with the next one.
  std::string why_told_;
  std::unique_ptr<ToldFacts> told_facts_;  ///< Null: the topic "facts" is not read.
  FleetPublisher publisher_;
};

}  // namespace stickslip::fleet
