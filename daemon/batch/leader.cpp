#include "daemon/batch/leader.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>
#include <vector>

#include "io/own_records.hpp"
#include "io/record_name.hpp"
#include <boost/asio/post.hpp>

#include "core/record/iso_time.hpp"
#include "core/record/method_text.hpp"
#include "daemon/batch/place.hpp"
#include "daemon/types/record_result.hpp"

namespace stickslip::batch {
namespace {

/// A new identifier of a batch. It begins with the time, so that it sorts among the names of records
/// (io/record_name.hpp).
std::string batch_id(std::int64_t realtime_ns, const daemon::BatchBook& book) {
  const std::time_t seconds = realtime_ns / 1'000'000'000;
  const std::string stem = fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(seconds));
  std::string id = stem;
  const auto taken = [&book](const std::string& text) {
    return std::any_of(book.batches().begin(), book.batches().end(),
                       [&text](const daemon::Batch& batch) { return batch.id == text; });
  };
  for (int attempt = 2; taken(id); ++attempt) id = fmt::format("{}-{}", stem, attempt);
  return id;
}

}  // namespace

BatchLeader::BatchLeader(Parts parts) : parts_(std::move(parts)), journal_(parts_.folder) {}

BatchLeader::~BatchLeader() { close(); }

void BatchLeader::close() { pool_.join(); }

std::string BatchLeader::now() const { return record::iso_time(parts_.clock->realtime_ns()); }

std::string BatchLeader::name_of(const std::filesystem::path& record) const {
  return daemon::name_in_journal(parts_.folder, record);
}

void BatchLeader::open() {
  read_on();
  reconcile();
  lead();
  const daemon::Batch* const batch = book_.current();
  if (batch == nullptr || !parts_.earlier) return;
  std::vector<std::string> records;
  for (const daemon::BatchTest& test : batch->tests) records.push_back(test.record);
  tell_earlier(std::move(records), 0);
}

std::int64_t BatchLeader::next_test_number() const {
  std::int64_t latest = 0;
  if (const daemon::Batch* const batch = book_.current(); batch != nullptr) {
    for (const daemon::BatchTest& test : batch->tests)
      latest = std::max(latest, io::test_number_in(test.record).value_or(0));
  }
  return latest + 1;
}

void BatchLeader::tell_earlier(std::vector<std::string> records, std::size_t at) {
  if (at == records.size()) return;
  boost::asio::post(pool_, [this, records = std::move(records), at] {
    auto test = daemon::earlier_test(parts_.program, parts_.folder / records[at]);
    parts_.on_main([this, records, at, test = std::move(test)] {
      // What cannot be read is `stickslip verify`'s to tell; the report of the batch says so too.
      if (test) parts_.earlier(*test);
      tell_earlier(records, at + 1);
    });
  });
}

void BatchLeader::read_on() {
  const base::Result<std::vector<std::string>> remarks = journal_.read_on(book_);
  trouble_.clear();
  if (!remarks) {
    trouble_ = remarks.error().message;
  } else if (!remarks->empty()) {
    trouble_ = remarks->front();
  }
}

const daemon::BatchBook& BatchLeader::book() {
  read_on();
  lead();
  return book_;
}

void BatchLeader::reconcile() {
  const daemon::Batch* const batch = book_.current();
  if (batch == nullptr) return;
  // Their names begin with the time, as the identifier of a batch does: where it was not ahead of today's,
  // only those above it can belong to the batch.
  const bool was_ahead = batch->id > io::record_stem(parts_.clock->realtime_ns() / 1'000'000'000, 0);
  std::vector<std::filesystem::path> files = io::own_records(parts_.folder);
  files.erase(std::remove_if(files.begin(), files.end(),
                             [&](const std::filesystem::path& file) {
                               return (!was_ahead && file.stem().string() <= batch->id) ||
                                      book_.has(batch->id, name_of(file));
                             }),
              files.end());
  io::keep_last(files, daemon::kMostSteps);
  for (const std::filesystem::path& file : files) {
    const auto place = place_of(parts_.program, file, name_of(file));
    // What cannot be read is `stickslip verify`'s to tell.
    if (!place || !*place || (*place)->batch != batch->id) continue;
    if (const auto written = journal_.append({now(), {}, **place}); !written)
      trouble_ = written.error().message;
  }
  read_on();
}

std::optional<daemon::BatchStep> BatchLeader::next() const {
  const daemon::Batch* const batch = book_.current();
  if (batch == nullptr) return std::nullopt;
  std::vector<daemon::BatchStep> begun;
  for (const auto& [number, step] : under_way_) begun.push_back(step);
  return book_.next_step(*batch, begun);
}

void BatchLeader::lead() {
  const daemon::Batch* const batch = book_.current();
  const std::string id = batch != nullptr ? batch->id : "";
  const std::optional<daemon::BatchStep> step = next();
  if (step == planned_ && id == led_batch_) return;
  // Without a batch before and now, the function has returned: the user's plan stays.
  daemon::Plan plan = parts_.plan();
  if (batch != nullptr) {
    // What a batch states holds for all its tests; the other facts are the user's, but for the lot of the
    // sample before.
    record::Metadata facts = std::exchange(plan.sample, batch->plan.sample).metadata;
    if (id != led_batch_) facts.erase(std::string{record::kLot});
    plan.sample.metadata = record::merged(facts, batch->plan.sample.metadata);
  }
  plan.sample.batch = step ? id : "";
  plan.sample.replicate = step ? std::optional{step->replicate} : std::nullopt;
  plan.sample.slide = step ? std::optional{step->slide} : std::nullopt;
  if (step && step->pull_speed_m_per_s) plan.pull_speed_m_per_s = step->pull_speed_m_per_s;
  plan.method.reset();
  if (batch != nullptr && !batch->plan.method.empty()) {
    if (auto method = record::method_from_text(batch->plan.method)) plan.method = *std::move(method);
  }
  planned_ = step;
  led_batch_ = id;
  parts_.set_plan(std::move(plan));
}

std::optional<daemon::BatchProgress> BatchLeader::progress() const {
  const daemon::Batch* const batch = book_.current();
  if (batch == nullptr) return std::nullopt;
  const std::vector<daemon::BatchStep> planned = daemon::steps(batch->plan);
  daemon::BatchProgress progress{batch->id, batch->plan.sample.name, 0, std::ssize(planned), next(),
                                 trouble_};
  for (const auto& [number, step] : under_way_) progress.under_way.push_back({number, step});
  for (const daemon::BatchStep& step : planned) {
    progress.done +=
        std::any_of(batch->tests.begin(), batch->tests.end(), [&](const daemon::BatchTest& test) {
          return test.step == step && book_.voided(test.record) == nullptr;
        });
  }
  return progress;
}

void BatchLeader::test_began(std::int64_t number) {
  if (!planned_) return;
  under_way_[number] = *planned_;
  lead();
}

void BatchLeader::record_published(std::int64_t number, const std::filesystem::path& file) {
  if (!under_way_.contains(number) && book_.current() == nullptr) return;
  // The record itself says which step it is of; the plan may have changed since it began.
  boost::asio::post(pool_, [this, number, file] {
    const auto place = place_of(parts_.program, file, name_of(file));
    base::Result<void> written;
    if (!place) {
      written = tl::unexpected(place.error());
    } else if (*place) {
      written = journal_.append({now(), {}, **place});
    }
    parts_.on_main([this, number, written] {
      under_way_.erase(number);
      read_on();
      // The record keeps its place; the next start adds it.
      if (!written) trouble_ = written.error().message;
      lead();
    });
  });
}

void BatchLeader::record_failed(std::int64_t number) {
  under_way_.erase(number);
  lead();
}

void BatchLeader::append(daemon::BatchEvent event, Answer answer) {
  boost::asio::post(pool_, [this, event = std::move(event), answer = std::move(answer)] {
    const base::Result<void> written = journal_.append(event);
    parts_.on_main([this, written, answer] {
      read_on();
      lead();
      answer(written);
    });
  });
}

void BatchLeader::begin(daemon::BatchPlan plan, std::string who, Answer answer) {
  read_on();
  if (const daemon::Batch* const batch = book_.current(); batch != nullptr && next()) {
    answer(tl::unexpected(base::Error{
        base::ErrorKind::kBusy, fmt::format("batch {} ({}) is not complete; end it first, or make its tests",
                                            batch->id, batch->plan.sample.name)}));
    return;
  }
  append({now(), std::move(who),
          daemon::BatchBegun{batch_id(parts_.clock->realtime_ns(), book_), std::move(plan)}},
         std::move(answer));
}

void BatchLeader::end(std::string who, Answer answer) {
  read_on();
  const daemon::Batch* const batch = book_.current();
  if (batch == nullptr) {
    answer(tl::unexpected(base::Error{base::ErrorKind::kBusy, "there is no batch"}));
    return;
  }
  append({now(), std::move(who), daemon::BatchEnded{batch->id}}, std::move(answer));
}

void BatchLeader::void_test(const std::string& record, std::string reason, std::string who, Answer answer) {
  read_on();
  if (const daemon::Voiding* const before = book_.voided(record)) {
    answer(tl::unexpected(
        base::Error{base::ErrorKind::kBusy,
                    fmt::format("{} is void already: {}, by {}", record, before->reason, before->who)}));
    return;
  }
  append({now(), std::move(who), daemon::TestVoided{record, std::move(reason)}}, std::move(answer));
}

void BatchLeader::restore(const std::string& record, std::string who, Answer answer) {
  read_on();
  if (book_.voided(record) == nullptr) {
    answer(tl::unexpected(base::Error{base::ErrorKind::kBusy, fmt::format("{} is not void", record)}));
    return;
  }
  append({now(), std::move(who), daemon::TestRestored{record}}, std::move(answer));
}

}  // namespace stickslip::batch
