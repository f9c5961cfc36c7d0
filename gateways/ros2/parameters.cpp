#include "parameters.h"

#include <algorithm>

#include "ros/messages.h"
#include "ros/parameter_services.h"

namespace ros2 {
namespace {

constexpr const char* sim_time = "use_sim_time";

ros::ParameterValue value_of(const std::string& name, bool is_sim_time) {
  ros::ParameterValue value;
  if (name == sim_time) {
    value.type = ros::ParameterValue::is_bool;
    value.bool_value = is_sim_time;
  }
  return value;
}

ros::SetParametersResult answer_to(const ros::Parameter& parameter, bool is_sim_time) {
  if (parameter.key != sim_time) return {false, "the node has no parameter \"" + parameter.key + "\"; it has use_sim_time"};
  if (parameter.value.type == ros::ParameterValue::is_bool && parameter.value.bool_value == is_sim_time) return {true, ""};
  return {false, is_sim_time ? "parameter use_sim_time is true and cannot be changed: the time is that of the simulation"
                             : "parameter use_sim_time is false and cannot be changed: times are those of the components"};
}

bool is_asked(const ros::ListParametersRequest& request) {
  return request.prefixes.empty() || std::ranges::find(request.prefixes, sim_time) != request.prefixes.end();
}

ros::ParameterDescriptor descriptor_of(const std::string& name, bool is_sim_time) {
  ros::ParameterDescriptor descriptor{.key = name, .type = value_of(name, is_sim_time).type};
  if (name == sim_time) {
    descriptor.description = "Whether the time of the node is that of /clock.";
    descriptor.read_only = true;
  }
  return descriptor;
}

// Serves a request with many entries by one answer for each.
template <class Request, class Response>
void serve_each(Node& node, const std::string& name, auto Request::*asked, auto Response::*answers, auto answer) {
  node.serve<Request, Response>(name, [=](const auto& request, const auto& reply) {
    Response response;
    for (const auto& one : request.*asked) (response.*answers).push_back(answer(one));
    reply(response);
  });
}

void serve_parameters(Node& node, bool is_sim_time) {
  using namespace ros;
  const std::string front = node.name().full() + "/";
  node.serve<ListParametersRequest, ListParametersResponse>(front + "list_parameters", [](const auto& request, const auto& reply) {
    ListParametersResponse response;
    if (is_asked(request)) response.result.names = {sim_time};
    reply(response);
  });
  serve_each(node, front + "get_parameters", &GetParametersRequest::names, &GetParametersResponse::values,
             [=](const std::string& one) { return value_of(one, is_sim_time); });
  serve_each(node, front + "get_parameter_types", &GetParameterTypesRequest::names, &GetParameterTypesResponse::types,
             [=](const std::string& one) { return value_of(one, is_sim_time).type; });
  serve_each(node, front + "describe_parameters", &DescribeParametersRequest::names, &DescribeParametersResponse::descriptors,
             [=](const std::string& one) { return descriptor_of(one, is_sim_time); });
  serve_each(node, front + "set_parameters", &SetParametersRequest::parameters, &SetParametersResponse::results,
             [=](const Parameter& one) { return answer_to(one, is_sim_time); });
  node.serve<SetParametersAtomicallyRequest, SetParametersAtomicallyResponse>(front + "set_parameters_atomically",
                                                                              [is_sim_time](const auto& request, const auto& reply) {
                                                                                SetParametersAtomicallyResponse response{{true, ""}};
                                                                                for (const auto& one : request.parameters) {
                                                                                  if (response.result.successful)
                                                                                    response.result = answer_to(one, is_sim_time);
                                                                                }
                                                                                reply(response);
                                                                              });
}

}  // namespace

Writer* complete_node(Node& node, const NodeParameters& parameters) {
  Writer* log = node.advertise<ros::Log>("/rosout", {true, 100});
  node.advertise<ros::ParameterEvent>("/parameter_events", {false, 1000});
  if (parameters.are_served) serve_parameters(node, parameters.is_sim_time);
  return log;
}

}  // namespace ros2
