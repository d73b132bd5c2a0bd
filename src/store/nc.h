/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <netcdf.h>
#include <sys/stat.h>

#include "store/store_file.h"

/// A netCDF-4 file being made. It is built under a name of its own in the folder of `path` and
/// takes that path only when it is published, so that a file that cannot be made destroys nothing.
typedef struct lac_nc {
    int id;
    bool open, published;
    bool force;
    int fd;                      ///< by which space is reserved and the file sealed; -1: none
    struct lac_journal *journal; ///< of a file that grows; NULL: none
    char *path;                  ///< where it will be
    char *part;                  ///< where it is built
    bool replaces;               ///< takes the place of one file only
    struct stat old;             ///< which is this
} lac_nc;

/// Turns what netCDF returned into an error: `path: cannot WHAT: why`; LAC_OK where it is none.
lac_status lac_nc_check(const char *path, int code, lac_error *err, const char *what,
                        const char *name);

/// Refuses a path that is no file name: empty, a folder, a device, an address (netCDF would open
/// a connection).
/// @param exists  set where a file is there
lac_status lac_nc_path(const char *path, bool *exists, lac_error *err);

/// Creates the file under its temporary name; LAC_EINPUT where `path` exists without `force`.
lac_status lac_nc_create(lac_nc *file, const char *path, bool force, lac_error *err);

/// Puts values into a variable, the journal first. @return as netCDF, or what the system said
/// @param type  of the values: NC_DOUBLE or NC_UBYTE (of older versions also NC_INT64: long long)
int lac_nc_append(const lac_nc *file, nc_type type, int id, const size_t *start,
                  const size_t *count, const void *values);

/// The same without a journal. @param file  open in netCDF
int lac_nc_put_values(int file, nc_type type, int id, const size_t *start, const size_t *count,
                      const void *values);

/// Brings all that was put into the file, and marks it so in the journal. A full disk shows up
/// here.
lac_status lac_nc_sync(const lac_nc *file, lac_error *err);

/// Brings what was synced from the system's memory to the disk.
lac_status lac_nc_to_disk(const lac_nc *file, lac_error *err);

/// Gives the file its name; it may be open. LAC_EINPUT: another file has appeared there meanwhile.
lac_status lac_nc_publish(lac_nc *file, lac_error *err);

/// LAC_EIO where a file that was published surely stands at its path no more.
lac_status lac_nc_check_place(const lac_nc *file, lac_error *err);

/// Reserves disk space for `bytes` more in a file and its journal, and some for what HDF5 needs: a
/// disk that fills up under HDF5's hands leaves a file that cannot be opened. LAC_EIO where there
/// surely is no space.
lac_status lac_nc_reserve(const lac_nc *file, size_t bytes, lac_error *err);

/// Closes and seals the file, and removes its journal. LAC_EIO: the disk is full, or what was
/// published is gone from its place.
lac_status lac_nc_close(lac_nc *file, lac_error *err);

/// Closes what is open, removes what was not published, frees the names.
void lac_nc_clear(lac_nc *file);

/// Attributes of a variable or, with NC_GLOBAL, of the file; a text that is NULL or empty and a
/// number that is not finite are left out.
lac_status lac_nc_text(const lac_nc *file, int var, const char *name, const char *text,
                       lac_error *err);
lac_status lac_nc_number(const lac_nc *file, int var, const char *name, double value, bool whole,
                         lac_error *err);

/// The text of a global attribute, to be freed; "" where there is none or it is longer than
/// `bound`; NULL where memory is short. @param file  open in netCDF
char *lac_nc_text_of(int file, const char *name, size_t bound);

/// What is kept of a file in FILE.journal.
struct lac_journal {
    int fd;
    off_t size;        ///< of what is good in it
    lac_archive ahead; ///< what comes after that, not yet written
    char *name, *part; ///< `base/temp_file.h`
    bool published;
    bool needed; ///< HDF5 failed to write: it then may have dropped values of earlier syncs and
                 ///< closes all the same, so that the journal must stay
};

/// Begins a journal of a file that goes on growing once it is published: all that it holds by now,
/// which is synced, and from here on what lac_nc_append is given. HDF5 writes over its own
/// structure at each sync, so a kill in there can lose the whole file; the journal is only added
/// to. It gets its name with the file, and is removed when the file is closed well.
/// @return LAC_OK; LAC_EINPUT where another's file has that name; LAC_EIO; LAC_ENOMEM
lac_status lac_nc_keep_journal(lac_nc *file, lac_error *err);
lac_status lac_journal_publish(struct lac_journal *journal, const char *path, lac_error *err);

/// Adds values, or with `values` NULL the mark that all before it was synced.
int lac_journal_put(struct lac_journal *journal, const char *name, nc_type type, int rank,
                    const size_t *start, const size_t *count, const void *values);

/// Ends it. @param remove  its file too, if it still is this journal's
void lac_journal_free(struct lac_journal *journal, bool remove);

/// The name of a file's journal, its links followed. @return false where there is no such file
enum { LAC_JOURNAL_NAME = PATH_MAX + 16 };
bool lac_journal_name(const char *path, char name[LAC_JOURNAL_NAME]);

/// Whether a file has a journal that its writer left: the file was not closed, and the two belong
/// together.
/// @param loss  what of it cannot be read, or that all of one cannot, whosever it is; the counts
///              of records are not looked at
bool lac_journal_waits(const char *path, lac_store_loss *loss);

/// Writes what a file held when its journal was begun. @return false: errno says why
bool lac_journal_copy_base(const char *path, int to);

/// Puts into that copy, open in netCDF, all that was synced since.
int lac_journal_replay(const char *path, int id);

/// Whether somebody is writing a file, or has not yet done with its journal.
bool lac_nc_is_written(const char *path);

/// A whole copy of a file whose journal waits.
/// @param beside  it must be in the folder of the file; else /tmp is tried too
/// @param copy    its name, to be freed, and the file to be removed; NULL: there is nothing to mend
/// @param loss    what is not in it
lac_status lac_nc_mended_copy(const char *path, bool beside, char **copy, lac_store_loss *loss,
                              lac_error *err);

/// A checksum of bytes. @param sum  to go on from
uint64_t lac_nc_sum(uint64_t sum, const void *bytes, size_t size);

/// Puts a checksum behind the end of a closed file; where it cannot, the file stays without.
void lac_nc_seal(int fd);

typedef enum lac_seal { LAC_SEAL_NONE = 0, LAC_SEAL_SOUND, LAC_SEAL_BROKEN } lac_seal;

/// Whether a file of so many bytes is as it was sealed.
lac_seal lac_nc_seal_state(int fd, size_t size);

/// Looks at the part of an unsealed file that HDF5 would believe unseen. LAC_EIO: it is damaged.
lac_status lac_nc_heap(const char *path, int fd, size_t size, lac_error *err);
