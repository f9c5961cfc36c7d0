// Finds when and where a run failed: for each failure of its summary the time and the object, and from them where the page opens and what
// its time line marks. Pure; any thread.
#pragma once

#include "studio/recording_facts.h"

namespace page {

using studio::Json;

// `summary` as tools::page_summary() has it. "failures" become marks: [{time, kind, text, subject}], in the order of time; "at" and
// "select" are those of the first. A failure without an object is about the first component or model that its text names; one without a
// time is at the first ERROR state of its component, else at the end. Times are within the recording.
void mark_failures(Json& summary, const studio::RecordingFacts& facts, const Json& models);

}  // namespace page
