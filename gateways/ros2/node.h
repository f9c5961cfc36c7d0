// A node of ROS 2: topics and services, typed by the structures of ros/. Its endpoints end with it. Errors of DDS are logged, and the
// endpoint is left out. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dds/participant.h"
#include "graph.h"
#include "names.h"
#include "ros/cdr.h"
#include "ros/decode.h"
#include "ros/type_hash.h"
#include "service.h"

namespace ros2 {

struct Qos {
  bool is_transient = false;
  std::size_t depth = 10;
  std::string note{};  // "key=value;" beside what ROS 2 has in the user data
};

template <ros::Message T>
bool publish(Writer& writer, const T& message) {
  return writer.write(ros::encoded_size(message), [&](std::span<char> room) { ros::encode(message, room); });
}

class Node {
 public:
  Node(Participant& participant, Graph& graph, NodeName name);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  const NodeName& name() const { return name_; }
  Graph& graph() { return graph_; }

  // `topic` is a full name. Nothing when DDS has no room. The node owns the writer.
  template <ros::Message T>
  Writer* advertise(const std::string& topic, Qos qos = {}, bool is_large = false, std::function<void()> on_match = {}) {
    return add_writer({topic_on_wire(topic), type_on_wire(T::name), user_data_of<T>() + qos.note, qos.is_transient, qos.depth, is_large},
                      std::move(on_match));
  }
  // From reliable and from best effort writers. Messages that cannot be read are counted and left out.
  template <ros::Message T>
  void subscribe(const std::string& topic, std::function<void(const T&)> on_message) {
    const auto take = [this, on_message = std::move(on_message)](const Received& received) {
      if (const auto message = ros::decode<T>(received.bytes)) {
        on_message(*message);
      } else {
        ++damaged_;
      }
    };
    add_readers({topic_on_wire(topic), type_on_wire(T::name), user_data_of<T>()}, take);
  }
  // `on_request` receives the request, and the function that sends the reply, now or later.
  template <ros::Message Request, ros::Message Response>
  void serve(const std::string& service, std::function<void(const Request&, std::function<void(const Response&)>)> on_request) {
    add_service(service, service_types<Request, Response>(),
                [on_request = std::move(on_request)](std::span<const std::uint8_t> bytes, const ClientHashes&, const Reply& reply) {
                  const auto request = ros::decode<Request>(bytes);
                  if (!request) return false;
                  on_request(*request, [reply](const Response& response) { reply(ros::encode(response)); });
                  return true;
                });
  }
  // `Request2`: what newer clients send under the same name; told apart by the type hash of the client.
  template <ros::Message Request, ros::Message Request2, ros::Message Response>
  void serve_both(const std::string& service, std::function<void(const Request&, std::function<void(const Response&)>)> on_request,
                  std::function<void(const Request2&, std::function<void(const Response&)>)> on_newer) {
    add_service(service, service_types<Request, Response>(),
                [on_request = std::move(on_request), on_newer = std::move(on_newer), hash = ros::TypeHash::of<Request2>()](
                    std::span<const std::uint8_t> bytes, const ClientHashes& client, const Reply& reply) {
                  const auto answer = [reply](const Response& response) { reply(ros::encode(response)); };
                  if (client.request == hash) {
                    const auto newer = ros::decode<Request2>(bytes);
                    if (newer) on_newer(*newer, answer);
                    return newer.has_value();
                  }
                  const auto request = ros::decode<Request>(bytes);
                  if (request) on_request(*request, answer);
                  return request.has_value();
                });
  }
  // `Response2`: what newer clients expect for the same request; told apart by the type hash of the client's reply.
  template <ros::Message Request, ros::Message Response, ros::Message Response2>
  void serve_newer_reply(const std::string& service, std::function<void(const Request&, std::function<void(const Response&)>)> on_request,
                         std::function<Response2(const Response&)> to_newer) {
    add_service(service, service_types<Request, Response>(),
                [on_request = std::move(on_request), to_newer = std::move(to_newer), hash = ros::TypeHash::of<Response2>()](
                    std::span<const std::uint8_t> bytes, const ClientHashes& client, const Reply& reply) {
                  const auto request = ros::decode<Request>(bytes);
                  if (!request) return false;
                  const bool is_newer = client.reply == hash;
                  on_request(*request, [reply, to_newer, is_newer](const Response& response) {
                    reply(is_newer ? ros::encode(to_newer(response)) : ros::encode(response));
                  });
                  return true;
                });
  }
  // To be called some times a second while a service is called: sends replies whose client was not matched.
  void update(std::chrono::steady_clock::time_point now);
  // Messages and requests that could not be read.
  std::uint64_t damaged() const;
  const std::vector<std::unique_ptr<Writer>>& writers() const { return writers_; }

 private:
  template <ros::Message T>
  static std::string user_data_of() {
    return "typehash=" + ros::TypeHash::of<T>() + ";";
  }
  template <ros::Message Request, ros::Message Response>
  static ServiceTypes service_types() {
    return {type_on_wire(Request::name), type_on_wire(Response::name), ros::TypeHash::of<Request>(), ros::TypeHash::of<Response>()};
  }
  Writer* add_writer(EndpointSettings settings, std::function<void()> on_match);
  void add_readers(EndpointSettings settings, const std::function<void(const Received&)>& take);
  void add_service(const std::string& service, ServiceTypes types, OnRequest on_request);

  Participant& participant_;
  Graph& graph_;
  const NodeName name_;
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<std::unique_ptr<Reader>> readers_;
  std::vector<std::unique_ptr<Service>> services_;
  std::uint64_t damaged_ = 0;
};

}  // namespace ros2
