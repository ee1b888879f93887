#include "daemon/charts/keeper.hpp"

#include <algorithm>
#include <exception>
#include <future>
#include <utility>

#include "io/json_text.hpp"
#include "io/own_records.hpp"
#include <boost/asio/post.hpp>

#include "core/record/iso_time.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::charts {

void Keeper::post(std::function<void()> work) {
  boost::asio::post(pool_, [this, work = std::move(work)] {
    try {
      work();
    } catch (const std::exception& error) {
      if (parts_.troubled) parts_.troubled(error.what());
      const std::lock_guard lock{mutex_};
      state_.trouble = error.what();
    }
  });
}

void Keeper::open() {
  post([this] { begin(); });
}

void Keeper::record_published(const std::filesystem::path& file) {
  post([this, file] {
    add(file);
    evaluate();
  });
}

void Keeper::settle() {
  std::promise<void> done;
  boost::asio::post(pool_, [&done] { done.set_value(); });
  done.get_future().wait();
}

void Keeper::close() {
  closing_ = true;
  pool_.join();
}

void Keeper::look() {
  if (looking_.exchange(true)) return;
  post([this] {
    looking_ = false;
    evaluate();
  });
}

void Keeper::ask(std::function<void(std::string)> answer) {
  post([this] { evaluate(); });
  // Whatever became of that: its trouble is in the state.
  post([this, answer = std::move(answer)] {
    answer(io::json_text(daemon::trend_course_json(charts_, state_)));
  });
}

daemon::TrendState Keeper::state() const {
  const std::lock_guard lock{mutex_};
  return state_;
}

void Keeper::begin() {
  evaluate();
  std::vector<std::filesystem::path> files = io::own_records(parts_.folder);
  const std::map<std::string, std::string>& known = history_->records();
  std::erase_if(files, [&known](const std::filesystem::path& file) {
    const std::string name = file.stem().string();
    return known.contains(name) || (!known.empty() && name < known.begin()->first);
  });
  io::keep_last(files, kMostAdded);
  for (const std::filesystem::path& file : files) {
    if (closing_) return;
    add(file);
  }
  evaluate();
}

void Keeper::add(const std::filesystem::path& file) {
  const auto facts = record::read_facts_apart(file);
  // What cannot be read is `stickslip verify`'s to tell.
  if (!facts || history_->has(facts->header.uuid)) return;
  const auto event = daemon::test_event(*facts, daemon::name_in_journal(parts_.folder, file));
  if (!event) return;
  const auto written = history_->append({*event});
  // The record stays; the next start adds it.
  trouble_ = written ? std::string{} : written.error().message;
}

void Keeper::evaluate() {
  auto remarks = history_->read_on();
  // At the start, and after the file was replaced.
  if (remarks && remarks->empty() && history_->reference() != parts_.reference) {
    const auto named = history_->append(
        {{record::iso_time(parts_.clock->realtime_ns()), daemon::ReferenceNamed{parts_.reference}}});
    if (!named) trouble_ = named.error().message;
    remarks = history_->read_on();
  }
  static_cast<void>(batches_.read_on(book_));  // The batch tells its own trouble.
  if (book_.voidings() != voided_ || charts_.reference() != history_->reference()) {
    charts_ = trend::TesterCharts{history_->reference()};
    voided_ = book_.voidings();
    history_ = std::make_unique<daemon::TesterHistory>(parts_.folder);
    remarks = history_->read_on();
  }
  if (!remarks) {
    // One that became shorter was replaced: the next time it is read from its beginning.
    charts_ = trend::TesterCharts{};
    history_ = std::make_unique<daemon::TesterHistory>(parts_.folder);
  }
  for (const daemon::HistoryEvent& event : history_->events()) daemon::apply(event, book_, charts_);
  history_->forget();
  if (remarks && !remarks->empty() && left_out_.empty()) left_out_ = remarks->front();
  std::string trouble = !remarks ? remarks.error().message : !trouble_.empty() ? trouble_ : left_out_;
  daemon::TrendState state = daemon::trend_state(charts_);
  if (!trouble.empty() && trouble != state_.trouble && parts_.troubled) parts_.troubled(trouble);
  state.trouble = std::move(trouble);
  std::set<std::string> alarmed;
  for (const base::Finding& finding : state.findings) {
    alarmed.insert(finding.code);
    if (!alarmed_.contains(finding.code)) parts_.alarmed(finding);
  }
  alarmed_ = std::move(alarmed);
  const std::lock_guard lock{mutex_};
  state_ = std::move(state);
}

}  // namespace stickslip::charts
