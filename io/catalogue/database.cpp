#include "io/catalogue/database.hpp"

#include <sqlite3.h>

#include "core/base/contract.hpp"

namespace stickslip::catalogue {
namespace {

/// Another process writes for some milliseconds at a time.
constexpr int kPatience_ms = 10'000;

Trouble trouble_of(int code) {
  constexpr int kPrimary = 0xff;
  switch (code & kPrimary) {
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
    // The program's SQL is right: the tables, or what is in them, are not those that it made.
    case SQLITE_ERROR:
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
      return Trouble::kDamage;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Trouble::kLocked;
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return Trouble::kNoPlace;
    default:
      return Trouble::kOther;
  }
}

[[noreturn]] void refuse(sqlite3* database, int code) {
  throw SqlError(database != nullptr ? ::sqlite3_errmsg(database) : ::sqlite3_errstr(code), trouble_of(code));
}

void check(sqlite3* database, int code) {
  if (code != SQLITE_OK) refuse(database, code);
}

int bind_one(sqlite3_stmt* statement, int index, const Value& value) {
  struct Binder {
    sqlite3_stmt* statement;
    int index;
    int operator()(std::monostate) const { return ::sqlite3_bind_null(statement, index); }
    int operator()(std::int64_t whole) const { return ::sqlite3_bind_int64(statement, index, whole); }
    int operator()(double number) const { return ::sqlite3_bind_double(statement, index, number); }
    int operator()(const std::string& text) const {
      return ::sqlite3_bind_text64(statement, index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
    }
    int operator()(const Bytes& path) const {
      return ::sqlite3_bind_blob64(statement, index, path.bytes.data(), path.bytes.size(), SQLITE_TRANSIENT);
    }
  };
  return std::visit(Binder{statement, index}, value);
}

}  // namespace

Statement::Statement(sqlite3* database, const std::string& sql)
    : statement_(nullptr, &::sqlite3_finalize), database_(database) {
  sqlite3_stmt* statement = nullptr;
  check(database, ::sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr));
  statement_.reset(statement);
}

void Statement::bind(const std::vector<Value>& values) {
  STICKSLIP_EXPECTS(static_cast<int>(values.size()) == ::sqlite3_bind_parameter_count(statement_.get()));
  ::sqlite3_reset(statement_.get());
  int index = 0;
  for (const Value& value : values) check(database_, bind_one(statement_.get(), ++index, value));
}

bool Statement::step() {
  const int code = ::sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) refuse(database_, code);
  return code == SQLITE_ROW;
}

void Statement::run(const std::vector<Value>& values) {
  bind(values);
  step();
  ::sqlite3_reset(statement_.get());
}

std::int64_t Statement::whole(int column) const { return ::sqlite3_column_int64(statement_.get(), column); }

std::string Statement::text(int column) const {
  const void* const bytes = ::sqlite3_column_blob(statement_.get(), column);
  const int size = ::sqlite3_column_bytes(statement_.get(), column);
  return bytes == nullptr ? std::string{}
                          : std::string{static_cast<const char*>(bytes), static_cast<std::size_t>(size)};
}

std::optional<std::int64_t> Statement::maybe_whole(int column) const {
  if (::sqlite3_column_type(statement_.get(), column) != SQLITE_INTEGER) return std::nullopt;
  return whole(column);
}

std::optional<double> Statement::maybe_number(int column) const {
  if (::sqlite3_column_type(statement_.get(), column) == SQLITE_NULL) return std::nullopt;
  return ::sqlite3_column_double(statement_.get(), column);
}

Database::Database(const std::string& path) : database_(nullptr, &::sqlite3_close) {
  sqlite3* database = nullptr;
  const int code =
      ::sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  database_.reset(database);
  check(database, code);
  check(database, ::sqlite3_busy_timeout(database, kPatience_ms));
}

void Database::run(const std::string& sql) {
  check(database_.get(), ::sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr));
}

std::int64_t Database::last_id() const { return ::sqlite3_last_insert_rowid(database_.get()); }

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const SqlError&) {  // SQLite has undone it already.
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace stickslip::catalogue
