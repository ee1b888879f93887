// Asio and Beast compiled once for all of the daemon.
#include <utility>  // Boost 1.74 on GCC 12 needs it first.

#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>
