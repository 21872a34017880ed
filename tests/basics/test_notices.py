"""Notices go by Python's logging: printed once, silenced and redirected as usual."""

import logging

from stickslip.basics.notices import logger, notify


def test_a_notice_is_one_line_on_stderr_until_the_level_is_higher(capsys, monkeypatch):
    notify("compiling")
    assert capsys.readouterr().err == "compiling\n"
    monkeypatch.setattr(logger(), "level", logging.WARNING)
    logger().manager._clear_cache()
    notify("compiling")
    assert capsys.readouterr().err == ""
    logger().manager._clear_cache()


def test_a_notice_is_a_record_for_handlers_and_is_not_printed_twice(caplog, capsys, monkeypatch):
    printing = logging.StreamHandler()
    monkeypatch.setattr(logging.getLogger(), "handlers", [*logging.getLogger().handlers, printing])
    with caplog.at_level(logging.INFO):
        notify("compiling")
    assert [record.name for record in caplog.records] == ["stickslip"] and capsys.readouterr().err == "compiling\n"
