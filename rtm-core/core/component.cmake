# Life cycle, execution contexts, configuration.
target_sources(rt_core PRIVATE configuration.cpp execution_context.cpp lifecycle.cpp workers.cpp)
