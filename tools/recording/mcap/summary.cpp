#include "recording/mcap/summary.h"

#include <algorithm>

#include "recording/mcap/compression.h"

namespace mcap {

void count(Statistics& statistics, const Message& message, std::uint64_t& of_channel) {
  const bool is_first = statistics.messages == 0;
  statistics.first = is_first ? message.log_time : std::min(statistics.first, message.log_time);
  statistics.last = is_first ? message.log_time : std::max(statistics.last, message.log_time);
  ++statistics.messages;
  ++of_channel;
}

std::string end_of_file(const Summary& summary, std::uint64_t start, std::uint32_t crc) {
  std::string out;
  std::string data_end;
  put(data_end, crc);
  put_record(out, Opcode::data_end, data_end);

  const std::uint64_t summary_start = start + out.size();
  const std::size_t first = out.size();
  std::string offsets;
  std::size_t group = out.size();
  const auto end_group = [&](Opcode opcode) {
    if (out.size() == group) return;
    std::string content;
    content.push_back(static_cast<char>(opcode));
    put(content, start + group);
    put(content, static_cast<std::uint64_t>(out.size() - group));
    put_record(offsets, Opcode::summary_offset, content);
    group = out.size();
  };
  for (const auto& [id, schema] : summary.schemas) put_schema(out, schema);
  end_group(Opcode::schema);
  for (const auto& [id, channel] : summary.channels) put_channel(out, channel);
  end_group(Opcode::channel);
  put_statistics(out, summary.statistics);
  end_group(Opcode::statistics);
  for (const ChunkEntry& entry : summary.chunks) put_chunk_index(out, entry);
  end_group(Opcode::chunk_index);
  for (const AttachmentPlace& place : summary.attachments) put_attachment_index(out, place);
  end_group(Opcode::attachment_index);
  for (const MetadataPlace& place : summary.metadata) put_metadata_index(out, place);
  end_group(Opcode::metadata_index);

  const std::uint64_t offsets_start = start + out.size();
  out += offsets;
  out.push_back(static_cast<char>(Opcode::footer));
  put(out, std::uint64_t{footer_record - record_head});
  put(out, summary_start);
  put(out, offsets_start);
  put(out, crc32(0, std::string_view(out).substr(first)));
  out.append(magic);
  return out;
}

}  // namespace mcap
