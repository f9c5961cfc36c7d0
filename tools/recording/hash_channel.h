// Writes the hash log of a run (docs/hash-logs.md) to the channel /hashes, a sample per tick in which something changed. One thread at a
// time.
#pragma once

#include <string>

#include "base/result.h"
#include "channels/exchange.h"

namespace recorder {

// The whole file, into a channel that it opens and closes. Fails when it is no hash log, or a damaged one.
base::Result<void> put_hashes(channels::Exchange& exchange, const std::string& file);

}  // namespace recorder
