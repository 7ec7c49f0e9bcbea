from contactstudy.study.dispatch import Dispatcher
from contactstudy.study.work import Job


def jobs(*groups):
    return [
        Job(f"{name}{number}", "", {}, "", "summary", operator=name) for name, size in groups for number in range(size)
    ]


def test_groups_stay_together_and_in_order():
    dispatcher = Dispatcher(jobs(("a", 3), ("b", 2)))
    first = [dispatcher.next_job("one").id for _ in range(3)]
    second = [dispatcher.next_job("two").id for _ in range(2)]
    assert (first, second) == (["a0", "a1", "a2"], ["b0", "b1"])
    assert dispatcher.next_job("one") is None


def test_an_idle_worker_takes_over_the_later_half():
    dispatcher = Dispatcher(jobs(("a", 6)))
    assert dispatcher.next_job("one").id == "a0"
    assert [dispatcher.next_job("two").id for _ in range(3)] == ["a3", "a4", "a5"]
    assert [dispatcher.next_job("one").id for _ in range(2)] == ["a1", "a2"]
    assert dispatcher.waiting == 0


def test_jobs_of_a_lost_worker_go_to_others():
    dispatcher = Dispatcher(jobs(("a", 3)))
    dispatcher.next_job("one")
    dispatcher.forget("one")
    assert [dispatcher.next_job("two").id for _ in range(2)] == ["a1", "a2"]
    assert dispatcher.next_job("two") is None


def test_every_job_exactly_once():
    dispatcher = Dispatcher(jobs(("a", 7), ("b", 1), ("c", 4)))
    seen = []
    while dispatcher.waiting:
        seen += [job.id for worker in "xyz" if (job := dispatcher.next_job(worker)) is not None]
    assert sorted(seen) == sorted(job.id for job in jobs(("a", 7), ("b", 1), ("c", 4)))
