// A shared library that is no plugin, though it has a function of that name.
extern "C" __attribute__((visibility("default"))) int tomlin_register_plugin(void*, char*,
                                                                             unsigned long) {
  return 0;
}
