// Standard output as a command sees it. Any thread.
#pragma once

namespace editor {

// The reader of a pipe has gone, as after `rtse print PORT | head`.
bool output_is_closed();

// Writes what is buffered; false when it could not be written and somebody would have wanted it.
bool flush_output();

}  // namespace editor
