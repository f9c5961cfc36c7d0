# Manager, modules, naming, logging.
target_sources(openrtm PRIVATE
  rtm/SystemLogger.cpp)
