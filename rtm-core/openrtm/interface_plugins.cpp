#include "openrtm/interface_plugins.h"

#include <cstring>
#include <set>

#include "base/guarded.h"
#include "base/text.h"
#include "component/runtime_access.h"
#include "corba/transport/payload.h"
#include "rtm/InPortConsumer.h"
#include "rtm/InPortProvider.h"
#include "rtm/NVUtil.h"
#include "rtm/OutPortConsumer.h"
#include "rtm/OutPortProvider.h"

namespace RTC {

void InterfaceProvider::publishInterfaceProfile(SDOPackage::NVList& properties) {
  for (const auto& [key, value] :
       {std::pair("dataport.interface_type", &interface_type_), std::pair("dataport.dataflow_type", &dataflow_type_),
        std::pair("dataport.subscription_type", &subscription_type_)}) {
    if (!value->empty()) NVUtil::appendStringValue(properties, key, value->c_str());
  }
  NVUtil::append(properties, m_properties);
}

bool InterfaceProvider::publishInterface(SDOPackage::NVList& properties) {
  if (!interface_type_.empty() && !NVUtil::isStringValue(properties, "dataport.interface_type", interface_type_.c_str())) return false;
  NVUtil::append(properties, m_properties);
  return true;
}

namespace detail {
namespace {

// Calls the author's code; false also if it throws, which is logged.
template <class Call>
bool guarded(Logger& rtclog, const char* what, Call call) {
  std::string thrown = "something that is no std::exception";
  try {
    return call();
  } catch (const std::exception& e) {
    thrown = e.what();
  } catch (const CORBA::Exception& e) {
    thrown = e._name();
  } catch (...) {
  }
  RTC_ERROR_STR(what << " threw " << thrown);
  return false;
}

// One end of an author, deleted by the factory that made it.
template <class End>
std::shared_ptr<End> make_end(const std::string& name, Logger& rtclog) {
  End* made = nullptr;
  guarded(rtclog, "the constructor", [&] { return (made = coil::GlobalFactory<End>::instance().createObject(name)) != nullptr; });
  if (made == nullptr) return nullptr;
  return std::shared_ptr<End>(made, [](End* end) { coil::GlobalFactory<End>::instance().deleteObject(end); });
}

// A consumer that has been given the profile.
template <class Consumer>
class Subscribed {
 public:
  Subscribed(std::shared_ptr<Consumer> consumer, const ConnectorProfile& profile, const std::string& name)
      : consumer_(std::move(consumer)), properties_(profile.properties), rtclog_(name.c_str()) {}
  ~Subscribed() {
    guarded(rtclog_, "unsubscribeInterface", [&] { return consumer_->unsubscribeInterface(properties_), true; });
  }
  Subscribed(const Subscribed&) = delete;
  Subscribed& operator=(const Subscribed&) = delete;

  // One call at a time.
  template <class Call>
  DataPortStatus call(const char* what, Call call) {
    DataPortStatus status = DataPortStatus::PORT_ERROR;
    const auto mine = turn_.take(turn_timeout);
    if (!mine) {
      auto& rtclog = rtclog_;
      RTC_WARN(("%s: the one before has not returned", what));
      return status;
    }
    guarded(rtclog_, what, [&] {
      status = call(*consumer_);
      return true;
    });
    return status;
  }

 private:
  const std::shared_ptr<Consumer> consumer_;
  const SDOPackage::NVList properties_;
  Logger rtclog_;
  base::UsersTurn turn_;
  static constexpr std::chrono::seconds turn_timeout{10};  // as calls of the ORB
};

class AuthorSender final : public corba::Sender {
 public:
  AuthorSender(std::shared_ptr<InPortConsumer> consumer, const ConnectorProfile& profile, const std::string& name, rt::ByteOrder order)
      : consumer_(std::move(consumer), profile, name), order_(order) {}

  rt::PortStatus send(corba::Payload& payload) override {
    ByteData data;
    try {
      const corba::Pieces& pieces = payload.pieces(order_);
      data.setDataLength(pieces.size);
      unsigned char* to = data.getBuffer();
      for (const auto& part : pieces.parts) {
        if (!part.empty()) std::memcpy(to, part.data(), part.size());
        to += part.size();
      }
    } catch (const CORBA::SystemException&) {
      return rt::PortStatus::error;  // no value of its type
    }
    data.setEndian(order_ == rt::ByteOrder::little);
    switch (consumer_.call("put", [&](InPortConsumer& consumer) { return consumer.put(data); })) {
      case DataPortStatus::PORT_OK:
        return rt::PortStatus::ok;
      case DataPortStatus::SEND_FULL:
      case DataPortStatus::BUFFER_FULL:
        return rt::PortStatus::send_full;
      case DataPortStatus::SEND_TIMEOUT:
      case DataPortStatus::BUFFER_TIMEOUT:
        return rt::PortStatus::send_timeout;
      case DataPortStatus::CONNECTION_LOST:
        return rt::PortStatus::connection_lost;
      case DataPortStatus::UNKNOWN_ERROR:
        return rt::PortStatus::unknown_error;
      default:
        return rt::PortStatus::error;
    }
  }

 private:
  Subscribed<InPortConsumer> consumer_;
  const rt::ByteOrder order_;
};

class AuthorFetcher final : public corba::Fetcher {
 public:
  AuthorFetcher(std::shared_ptr<OutPortConsumer> consumer, const ConnectorProfile& profile, const std::string& name, rt::ByteOrder order)
      : consumer_(std::move(consumer), profile, name), order_(order) {}

  rt::PortStatus fetch(rt::Sample& sample) override {
    ByteData data;
    data.setEndian(order_ == rt::ByteOrder::little);
    switch (consumer_.call("get", [&](OutPortConsumer& consumer) { return consumer.get(data); })) {
      case DataPortStatus::PORT_OK:
        break;
      case DataPortStatus::BUFFER_EMPTY:
      case DataPortStatus::RECV_EMPTY:
        return rt::PortStatus::buffer_empty;
      case DataPortStatus::RECV_TIMEOUT:
      case DataPortStatus::BUFFER_TIMEOUT:
        return rt::PortStatus::recv_timeout;
      case DataPortStatus::CONNECTION_LOST:
        return rt::PortStatus::connection_lost;
      case DataPortStatus::UNKNOWN_ERROR:
        return rt::PortStatus::unknown_error;
      default:
        return rt::PortStatus::error;
    }
    auto block = pool_->take(data.getDataLength());
    if (block->size() > 0) std::memcpy(block->data(), data.getBuffer(), block->size());
    sample.block = std::move(block);
    sample.order = order_;
    return rt::PortStatus::ok;
  }

 private:
  Subscribed<OutPortConsumer> consumer_;
  const rt::ByteOrder order_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
};

class AuthorCarrier final : public corba::Carrier {
 public:
  AuthorCarrier(const rt::ConnectorSettings& settings, std::shared_ptr<ConnectorBase> connector)
      : name_(settings.foreign_interface), order_(settings.order), connector_(std::move(connector)), rtclog_(name_.c_str()) {}

  std::unique_ptr<corba::Sender> make_sender(const ConnectorProfile& profile) override {
    auto consumer = subscribed<InPortConsumer>(profile, [](InPortConsumer&) {});
    return consumer ? std::make_unique<AuthorSender>(std::move(consumer), profile, name_, order_) : nullptr;
  }

  std::unique_ptr<corba::Fetcher> make_fetcher(const ConnectorProfile& profile) override {
    auto consumer = subscribed<OutPortConsumer>(profile, [this](OutPortConsumer& made) { introduce(made); });
    return consumer ? std::make_unique<AuthorFetcher>(std::move(consumer), profile, name_, order_) : nullptr;
  }

  std::shared_ptr<void> serve(std::weak_ptr<corba::Receiver> receiver, ConnectorProfile& profile) override {
    RuntimeAccess::serve(static_cast<InPortConnector&>(*connector_), receiver, order_ == rt::ByteOrder::little);
    return published<InPortProvider, InPortConnector>(profile);
  }

  std::shared_ptr<void> serve(std::weak_ptr<corba::Source> source, ConnectorProfile& profile) override {
    RuntimeAccess::serve(static_cast<OutPortConnector&>(*connector_), source, order_ == rt::ByteOrder::little);
    return published<OutPortProvider, OutPortConnector>(profile);
  }

 private:
  template <class End>
  void introduce(End& end) {
    ConnectorInfo info = connector_->profile();
    end.setBuffer(connector_->getBuffer());
    end.setListener(info, &RuntimeAccess::listeners(*connector_));
  }

  // With the name of the connection, for messages.
  coil::Properties named_properties() const {
    const auto& profile = connector_->profile();
    coil::Properties properties = profile.properties;
    properties.setProperty("connector_name", profile.name);
    return properties;
  }

  template <class Consumer, class Introduce>
  std::shared_ptr<Consumer> subscribed(const ConnectorProfile& profile, Introduce introduce_it) {
    auto consumer = make_end<Consumer>(name_, rtclog_);
    if (!consumer) return nullptr;
    const bool is_good = guarded(rtclog_, "init or subscribeInterface", [&] {
      coil::Properties properties = named_properties();
      consumer->init(properties);
      introduce_it(*consumer);
      return consumer->subscribeInterface(profile.properties);
    });
    return is_good ? consumer : nullptr;
  }

  template <class Provider, class Connector>
  std::shared_ptr<Provider> published(ConnectorProfile& profile) {
    auto provider = make_end<Provider>(name_, rtclog_);
    if (!provider) return nullptr;
    const bool is_good = guarded(rtclog_, "init, publishInterface or setConnector", [&] {
      coil::Properties properties = named_properties();
      provider->init(properties);
      if (!provider->publishInterface(profile.properties)) return false;
      introduce(*provider);
      provider->setConnector(&static_cast<Connector&>(*connector_));
      return true;
    });
    if (!is_good) return nullptr;
    // The connector outlives the provider, whose threads use it.
    return std::shared_ptr<Provider>(provider.get(), [provider, connector = connector_](Provider*) mutable { provider.reset(); });
  }

  const std::string name_;
  const rt::ByteOrder order_;
  const std::shared_ptr<ConnectorBase> connector_;
  Logger rtclog_;
};

}  // namespace

std::vector<std::string> interfaces_of_authors(rt::Side side) {
  const auto names = [](const std::vector<std::string>& pushing, const std::vector<std::string>& pulling) {
    std::set<std::string> all(pushing.begin(), pushing.end());
    all.insert(pulling.begin(), pulling.end());
    return std::vector<std::string>(all.begin(), all.end());
  };
  return side == rt::Side::in
             ? names(InPortProviderFactory::instance().getIdentifiers(), OutPortConsumerFactory::instance().getIdentifiers())
             : names(InPortConsumerFactory::instance().getIdentifiers(), OutPortProviderFactory::instance().getIdentifiers());
}

coil::Properties options_of_author_interface(const std::string& name, rt::Side side) {
  const bool is_in = side == rt::Side::in;
  coil::Properties options =
      is_in ? InPortProviderFactory::instance().getProperties(name) : InPortConsumerFactory::instance().getProperties(name);
  options << (is_in ? OutPortConsumerFactory::instance().getProperties(name) : OutPortProviderFactory::instance().getProperties(name));
  return options;
}

std::shared_ptr<corba::Carrier> make_author_carrier(const rt::ConnectorSettings& settings, std::shared_ptr<ConnectorBase> connector) {
  return std::make_shared<AuthorCarrier>(settings, std::move(connector));
}

}  // namespace detail
}  // namespace RTC
