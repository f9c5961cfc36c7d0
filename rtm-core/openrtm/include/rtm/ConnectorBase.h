// A connection of a data port as component authors see it. Objects belong to their port and live until it is disconnected. Any thread.
#pragma once

#include <coil/Properties.h>
#include <coil/stringutil.h>

#include <memory>
#include <string>
#include <vector>

#include "rtm/BufferStatus.h"
#include "rtm/CdrBufferBase.h"
#include "rtm/DataPortStatus.h"
#include "rtm/idl/RTCStub.h"

namespace RTC {

class ByteData;
class PortBase;
class ConnectorListeners;

// `ports` are stringified references; `properties` are the port's own (with its `data_type`), over them the connection's without the prefix
// "dataport.".
class ConnectorInfo {
 public:
  ConnectorInfo() = default;
  ConnectorInfo(const char* name_, const char* id_, coil::vstring ports_, coil::Properties properties_)
      : name(name_), id(id_), ports(std::move(ports_)), properties(std::move(properties_)) {}
  std::string name;
  std::string id;
  coil::vstring ports;
  coil::Properties properties;
};
using ConnectorInfoList = std::vector<ConnectorInfo>;

class ConnectorBase : public DataPortStatus {
 public:
  ConnectorBase(PortBase& port, std::shared_ptr<ConnectorListeners> listeners, ConnectorInfo info);
  virtual ~ConnectorBase();
  ConnectorBase(const ConnectorBase&) = delete;
  ConnectorBase& operator=(const ConnectorBase&) = delete;

  ConnectorInfo profile() const;
  const char* id() const { return id_.c_str(); }
  const char* name() const { return name_.c_str(); }
  // What waits in this side of the connection.
  CdrBufferBase* getBuffer() { return &buffer_; }
  // Takes the whole connection apart; the object is gone afterwards.
  DataPortStatus disconnect();

 private:
  friend class RuntimeAccess;
  struct Impl;

  ConnectorListeners& listeners();
  // What listeners get from now on.
  void setInfo(ConnectorInfo info);
  std::shared_ptr<ConnectorInfo> info() const;

  const std::string name_;
  const std::string id_;
  CdrBufferBase buffer_;
  std::unique_ptr<Impl> impl_;
};

class InPortConnector : public ConnectorBase {
 public:
  using ConnectorBase::ConnectorBase;
  // What a transport of an author has brought: waits in the port from now on. OK, FULL, TIMEOUT or BUFFER_ERROR, after the end of the
  // connection and on those of other transports PRECONDITION_NOT_MET.
  BufferStatus write(const ByteData& data);
  bool isLittleEndian() const { return is_little_; }

 private:
  friend class RuntimeAccess;
  std::weak_ptr<void> receiver_;
  bool is_little_ = true;
};

class OutPortConnector : public ConnectorBase {
 public:
  using ConnectorBase::ConnectorBase;
  // The next sample, for a transport of an author: OK, EMPTY, TIMEOUT or BUFFER_ERROR, else as above.
  BufferStatus read(ByteData& data);
  bool isLittleEndian() const { return is_little_; }

 private:
  friend class RuntimeAccess;
  std::weak_ptr<void> source_;
  bool is_little_ = true;
};

}  // namespace RTC
