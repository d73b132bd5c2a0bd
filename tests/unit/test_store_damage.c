// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of a file whose writer was killed, whose disk was full, or whose bytes have changed.
// Each writer and reader runs in a process of its own, so that a crash or a hang is a finding.
#include <stdlib.h>
#include <string.h>

#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/rng.h"
#include "lacuna/simulation.h"
#include "store/store.h"
#include "support/scratch_group.h"
#include "support/store_records.h"
#include "support/test.h"

enum { KILLS = 25, DAMAGED = 300, PATIENCE = 10 /* seconds */ };

// Waits for a child; its exit status, or 1000 + the signal that ended it.
static int outcome(pid_t child)
{
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status);
}

// Writes records for ever, telling after each one that it is safe.
static void write_for_ever(const char *path, int pipe_end, int64_t sync_every)
{
    lac_store_def def = store_def(path);
    def.sync_every = sync_every;
    def.force = true;
    lac_store *store = NULL;
    if (lac_store_create(&def, &store, NULL) != LAC_OK) {
        _exit(1);
    }
    lac_sink sink = lac_store_sink(store);
    for (size_t i = 0;; i++) {
        lac_record record = record_of(i);
        if (sink.record(sink.context, &record, NULL) != LAC_OK ||
            write(pipe_end, &i, sizeof i) != sizeof i) {
            _exit(1);
        }
    }
}

// Kills a writer after some records; how many it said it had given.
static size_t kill_writer(const char *path, int64_t sync_every, size_t after, useconds_t later)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        (void)close(ends[0]);
        write_for_ever(path, ends[1], sync_every);
    }
    (void)close(ends[1]);
    size_t last = 0;
    while (last + 1 < after) {
        assert_int_equal(read(ends[0], &last, sizeof last), sizeof last);
    }
    (void)usleep(later);
    assert_int_equal(kill(child, SIGKILL), 0);
    while (read(ends[0], &last, sizeof last) == sizeof last) {
    }
    (void)close(ends[0]);
    assert_int_equal(outcome(child), 1000 + SIGKILL);
    return last + 1;
}

static void synced_records_survive_kill(void **state)
{
    (void)state;
    for (size_t k = 0; k < test_some(KILLS); k++) {
        const size_t batch = k % 2 == 0 ? 1 : 8;
        const char *path = scratch_path(&folder, "killed.nc");
        size_t given = kill_writer(path, (int64_t)batch, 20 + 7 * k, (useconds_t)(37 * k));
        size_t n = 0;
        lac_error err = {{0}};
        char text[32];
        if (check_records(path, &n, &err) != LAC_OK) {
            fail_msg("%s", err.message);
        }
        assert_int_equal(lac_store_read_attribute(path, "status", text, sizeof text, &err), LAC_OK);
        assert_string_equal(text, "running");
        // the batch in the making may be lost, none that was synced
        assert_true(n >= given / batch * batch);
        assert_true(n <= given + batch);
    }
}

static void die_of_full_disk(const char *path)
{
    const struct rlimit limit = {.rlim_cur = 2000000, .rlim_max = 2000000};
    (void)signal(SIGXFSZ, SIG_IGN);
    (void)setrlimit(RLIMIT_FSIZE, &limit);
    lac_error err = {{0}};
    lac_store_def def = store_def(path);
    lac_store *store = NULL;
    lac_status status = lac_store_create(&def, &store, &err);
    for (size_t i = 0; i < 100000 && status == LAC_OK; i++) {
        lac_sink sink = lac_store_sink(store);
        lac_record record = record_of(i);
        status = sink.record(sink.context, &record, &err);
    }
    if (status != LAC_EIO || strstr(err.message, "full.nc: cannot") == NULL) {
        _exit(1);
    }
    lac_run_result result = run_result();
    if (lac_store_finish(store, "failed", &result, 1.0, &err) != LAC_EIO) {
        _exit(2);
    }
    lac_store_free(store);
    _exit(strstr(err.message, "File too large") != NULL ? 0 : 3);
}

static void full_disk_is_an_error(void **state)
{
    (void)state;
    const char *path = scratch_path(&folder, "full.nc");
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        die_of_full_disk(path);
    }
    assert_int_equal(outcome(child), 0);
    size_t n = 0;
    lac_error err = {{0}};
    if (check_records(path, &n, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    print_message("%zu records before the disk was full\n", n);
    assert_true(n >= 100);
}

typedef enum verdict { UNHARMED, REFUSED, WRONG } verdict;

static verdict read_damaged(const char *path)
{
    // cmocka's handlers would go on with the tests in this process
    const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        (void)signal(signals[i], SIG_DFL);
    }
    (void)alarm(PATIENCE);
    size_t n = 0;
    lac_error err = {{0}};
    char text[64];
    lac_status status = check_records(path, &n, &err);
    if (status == LAC_OK) {
        (void)lac_store_read_attribute(path, "status", text, sizeof text, &err);
        return n == 1300 ? UNHARMED : WRONG;
    }
    return status == LAC_ENUMERIC ? WRONG : REFUSED;
}

static unsigned char *make_whole(size_t *size)
{
    lac_store_def def = store_def(scratch_path(&folder, "whole.nc"));
    lac_store *store = NULL;
    def.force = true;
    assert_int_equal(lac_store_create(&def, &store, NULL), LAC_OK);
    lac_sink sink = lac_store_sink(store);
    for (size_t i = 0; i < 1300; i++) {
        lac_record record = record_of(i);
        assert_int_equal(sink.record(sink.context, &record, NULL), LAC_OK);
    }
    lac_run_result result = run_result();
    assert_int_equal(lac_store_finish(store, "complete", &result, 1.0, NULL), LAC_OK);
    lac_store_free(store);
    return scratch_read(def.path, size);
}

static uint64_t draw(uint64_t k, uint64_t what)
{
    uint64_t words[4];
    lac_random(1, LAC_STREAM_TEST, k, what, words);
    return words[0];
}

// Damage k: cut short, a flipped bit, a run of zeros, or a run of noise.
static size_t damage(unsigned char *bytes, size_t size, uint64_t k)
{
    size_t at = draw(k, 0) % size;
    size_t length = 1 + draw(k, 1) % 64;
    switch (k % 4) {
    case 0:
        return at;
    case 1:
        bytes[at] ^= (unsigned char)(1u << (k / 4 % 8));
        return size;
    default:
        for (size_t i = at; i < size && i < at + length; i++) {
            bytes[i] = k % 4 == 2 ? 0 : (unsigned char)draw(i, 2);
        }
        return size;
    }
}

static void damage_never_crashes(void **state)
{
    (void)state;
    size_t size = 0;
    unsigned char *whole = make_whole(&size);
    unsigned char *bytes = malloc(size);
    assert_non_null(bytes);
    unsigned count[3] = {0, 0, 0};
    const size_t damaged = test_some(DAMAGED);
    for (uint64_t k = 0; k < damaged; k++) {
        memcpy(bytes, whole, size);
        size_t left = damage(bytes, size, k);
        const char *path = scratch_write(&folder, "damaged.nc", bytes, left);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            _exit((int)read_damaged(path));
        }
        int end = outcome(child);
        if (end > WRONG) {
            fail_msg("damage %d ended the reader: %d", (int)k, end);
        }
        count[end]++;
    }
    print_message("of %zu damaged files %u were refused, %u read without harm, %u read wrongly\n",
                  damaged, count[REFUSED], count[UNHARMED], count[WRONG]);
    assert_true(count[REFUSED] > damaged / 2);
    assert_int_equal(count[WRONG], 0);
    free(whole);
    free(bytes);
}

static uint64_t little_endian(const unsigned char *bytes, size_t count)
{
    uint64_t value = 0;
    for (size_t i = 0; i < count; i++) {
        value |= (uint64_t)bytes[i] << (8 * i);
    }
    return value;
}

// Where the global heap begins that HDF5 links variables to dimensions by: "GCOL", version 1.
static unsigned char *find_heap(unsigned char *bytes, size_t size)
{
    for (size_t i = 0; i + 32 < size; i++) {
        if (memcmp(bytes + i, "GCOL\1\0\0", 8) == 0) {
            return bytes + i;
        }
    }
    fail_msg("no global heap");
    return NULL;
}

static int read_with_size(unsigned char *bytes, size_t size, unsigned char *object, uint64_t value)
{
    unsigned char was[8];
    memcpy(was, object + 8, sizeof was);
    for (size_t i = 0; i < 8; i++) {
        object[8 + i] = (unsigned char)(value >> (8 * i));
    }
    const char *path = scratch_write(&folder, "heap.nc", bytes, size);
    memcpy(object + 8, was, sizeof was);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit((int)read_damaged(path));
    }
    return outcome(child);
}

// A file without a seal, as a killed writer leaves it. HDF5 1.10 loops for ever over free space of
// no size. The heap is walked here as the format says (HDF5 File Format Specification III.E): 16
// bytes before each object, its index, count and size; the last one, of index 0, is what is free.
static void heap_is_looked_at_before_hdf5_sees_it(void **state)
{
    (void)state;
    size_t size = 0;
    unsigned char *bytes = make_whole(&size);
    size -= 32; // the seal
    unsigned char *heap = find_heap(bytes, size);
    const size_t end = (size_t)little_endian(heap + 8, 8);
    size_t at = 16;
    size_t objects = 0;
    for (; little_endian(heap + at, 2) != 0; objects++) {
        const uint64_t length = little_endian(heap + at + 8, 8);
        if (!test_few() || objects < 4) {
            assert_int_equal(read_with_size(bytes, size, heap + at, length), UNHARMED);
            assert_int_equal(read_with_size(bytes, size, heap + at, end), REFUSED);
        }
        at += 16 + (size_t)((length + 7) / 8 * 8);
    }
    assert_true(objects > 3);
    assert_int_equal(little_endian(heap + at + 8, 8), end - at); // all that is left
    assert_int_equal(read_with_size(bytes, size, heap + at, end - at), UNHARMED);
    assert_int_equal(read_with_size(bytes, size, heap + at, 0), REFUSED);
    assert_int_equal(read_with_size(bytes, size, heap + at, end - at + 1), REFUSED);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(synced_records_survive_kill),
        cmocka_unit_test(full_disk_is_an_error),
        cmocka_unit_test(damage_never_crashes),
        cmocka_unit_test(heap_is_looked_at_before_hdf5_sees_it),
    };
    return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
