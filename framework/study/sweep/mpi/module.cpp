// tomlin_mpi.so, the only part of tomlin that is linked with MPI. The program loads it when a
// launcher has started several processes.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

#include <mpi.h>

#include "framework/study/sweep/process_link.hpp"

namespace {

using tomlin::ProcessLink;

constexpr int kTag = 1;

void send(void*, int to, const void* bytes, std::size_t size) {
  MPI_Send(bytes, static_cast<int>(size), MPI_BYTE, to, kTag, MPI_COMM_WORLD);
}

std::ptrdiff_t poll(void*, int* from) {
  int there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &there, &status);
  if (there == 0) return -1;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  *from = status.MPI_SOURCE;
  return size;
}

void receive(void*, int from, void* bytes, std::size_t size) {
  MPI_Recv(bytes, static_cast<int>(size), MPI_BYTE, from, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

void end(void*) { MPI_Finalize(); }

void write(std::string_view text, char* why, std::size_t size) {
  const std::size_t length = std::min(text.size(), size - 1);
  std::memcpy(why, text.data(), length);
  why[length] = '\0';
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const ProcessLink* tomlin_process_link(
    char* why, std::size_t size) {
  static ProcessLink link;
  int level = MPI_THREAD_SINGLE;
  // An error of MPI itself ends the process, and with it the others.
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
  if (level < MPI_THREAD_SERIALIZED) {
    write("this MPI takes calls from one thread only", why, size);
    MPI_Finalize();
    return nullptr;
  }
  link.format = tomlin::kProcessLinkFormat;
  MPI_Comm_rank(MPI_COMM_WORLD, &link.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &link.size);
  link.send = &send;
  link.poll = &poll;
  link.receive = &receive;
  link.end = &end;
  return &link;
}
