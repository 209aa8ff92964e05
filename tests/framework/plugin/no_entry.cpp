// A plugin by its note, without a way in.
extern "C" __attribute__((visibility("default"))) int another_function() { return 0; }
