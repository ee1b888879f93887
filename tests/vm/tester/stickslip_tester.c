// SPDX-License-Identifier: GPL-2.0-only
/*
 * stickslip_tester: a tester without hardware, for tests of stickslip on a real kernel. Never installed.
 *
 * A Comedi board with one analog input whose asynchronous command plays A/D codes from a firmware file
 * (16-bit, little-endian), one for each scan, then the last one for ever. Codes and time belong together: the
 * first command begins with the first code, and a command that comes later begins where the time since then has
 * got to, as a real force would have.
 *
 * Parameters, in /sys/module/stickslip_tester/parameters:
 *   codes           name of the firmware file; read when the board is attached
 *   restart         1: each command begins with the first code
 *   rate_error_ppb  the board's clock is fast by so many parts in 10^9 of the rate that it grants
 *   overrun         write N: the next N scans are lost, then the acquisition halts: an overflow of the board's FIFO
 *   attached        write 0: the board goes as an unplugged one does; 1: it returns
 *   position        reading: code that the next scan has
 *
 * The board is a device of the platform bus, so that udev has a path for it, and has a serial number as a board on USB
 * has.
 */
#include <linux/module.h>
#include <linux/moduleparam.h>
#include <linux/device.h>
#include <linux/firmware.h>
#include <linux/hrtimer.h>
#include <linux/math64.h>
#include <linux/mutex.h>
#include <linux/platform_device.h>
#include <linux/spinlock.h>
#include <linux/slab.h>
#include <linux/comedi/comedidev.h>

#define TESTER_NAME "stickslip_tester"
#define TESTER_SERIAL "01A2B3C4"
/* Rates up to 100 kHz: a scan must be worth an interrupt. */
#define SHORTEST_PERIOD_NS 10000U
/* Longer ones may not fit once the clock's error is added. */
#define LONGEST_PERIOD_NS NSEC_PER_SEC
#define ONE_IN_PPB 1000000000LL
/* Of one interrupt; more stay for the next one. */
#define MOST_SCANS 64

static char *codes = "stickslip-codes.bin";
module_param(codes, charp, 0444);
static bool restart;
module_param(restart, bool, 0644);
static int rate_error_ppb;
module_param(rate_error_ppb, int, 0644);

/* Range 0 and 1, in microvolts as Comedi has them: +-10 V and +-5 V. */
static const struct comedi_lrange tester_ranges = { 2, { BIP_RANGE(10), BIP_RANGE(5) } };

/* What the world holds, attached or not. */
static struct platform_device *tester_place;
static struct device *tester_parent;
static bool tester_is_attached;
static DEFINE_MUTEX(tester_plug);

/* Time went on while the board was away or idle, so these outlive it. */
static DEFINE_SPINLOCK(tester_time);
static bool tester_began;
static u64 tester_position;
static ktime_t tester_due;      /* of the scan at tester_position */
static u64 tester_fraction;     /* of a ns that tester_due is too early, in 2^-32 ns */
static unsigned int tester_overrun;

struct tester_private {
	struct hrtimer timer;
	struct comedi_device *dev;
	const struct firmware *file;
	u64 period;             /* true one, in 2^-32 ns */
	bool running;
};

static u16 tester_code(const struct tester_private *priv, u64 position)
{
	u64 count = priv->file->size / 2;
	u64 at = min(position, count - 1);

	return priv->file->data[2 * at] | priv->file->data[2 * at + 1] << 8;
}

/* One period on. */
static void tester_step(const struct tester_private *priv)
{
	u64 sum = tester_fraction + (priv->period & 0xFFFFFFFFULL);

	tester_due = ktime_add_ns(tester_due, (priv->period >> 32) + (sum >> 32));
	tester_fraction = sum & 0xFFFFFFFFULL;
	++tester_position;
}

static enum hrtimer_restart tester_interrupt(struct hrtimer *timer)
{
	struct tester_private *priv = container_of(timer, struct tester_private, timer);
	struct comedi_device *dev = priv->dev;
	struct comedi_subdevice *s = dev->read_subdev;
	ktime_t now = ktime_get();
	unsigned long flags;
	unsigned int count = 0;
	u16 scan;

	if (!READ_ONCE(priv->running))
		return HRTIMER_NORESTART;
	spin_lock_irqsave(&tester_time, flags);
	while (count < MOST_SCANS && ktime_compare(tester_due, now) <= 0) {
		if (tester_overrun) {
			if (--tester_overrun == 0)
				s->async->events |= COMEDI_CB_OVERFLOW;
		} else {
			scan = tester_code(priv, tester_position);
			/* A full buffer is an overflow by itself. */
			if (!comedi_buf_write_samples(s, &scan, 1))
				break;
		}
		tester_step(priv);
		++count;
		if (s->async->events & COMEDI_CB_CANCEL_MASK)
			break;
	}
	if (!(s->async->events & COMEDI_CB_CANCEL_MASK))
		hrtimer_set_expires(timer, tester_due);
	spin_unlock_irqrestore(&tester_time, flags);

	if (s->async->events & COMEDI_CB_CANCEL_MASK) {
		WRITE_ONCE(priv->running, false);
		comedi_event(dev, s);
		return HRTIMER_NORESTART;
	}
	comedi_event(dev, s);
	return HRTIMER_RESTART;
}

static int tester_cmdtest(struct comedi_device *dev, struct comedi_subdevice *s, struct comedi_cmd *cmd)
{
	int err = 0;

	err |= comedi_check_trigger_src(&cmd->start_src, TRIG_NOW);
	err |= comedi_check_trigger_src(&cmd->scan_begin_src, TRIG_TIMER);
	err |= comedi_check_trigger_src(&cmd->convert_src, TRIG_NOW);
	err |= comedi_check_trigger_src(&cmd->scan_end_src, TRIG_COUNT);
	err |= comedi_check_trigger_src(&cmd->stop_src, TRIG_NONE);
	if (err)
		return 1;

	err |= comedi_check_trigger_arg_is(&cmd->start_arg, 0);
	err |= comedi_check_trigger_arg_min(&cmd->scan_begin_arg, SHORTEST_PERIOD_NS);
	err |= comedi_check_trigger_arg_max(&cmd->scan_begin_arg, LONGEST_PERIOD_NS);
	err |= comedi_check_trigger_arg_is(&cmd->convert_arg, 0);
	err |= comedi_check_trigger_arg_is(&cmd->scan_end_arg, 1);
	err |= comedi_check_trigger_arg_is(&cmd->stop_arg, 0);
	if (err)
		return 3;
	/* Each period of whole ns is granted as it is. */
	return 0;
}

static int tester_cmd(struct comedi_device *dev, struct comedi_subdevice *s)
{
	struct tester_private *priv = dev->private;
	u64 granted = (u64)s->async->cmd.scan_begin_arg << 32;
	unsigned long flags;
	ktime_t now;

	priv->period = mul_u64_u64_div_u64(granted, ONE_IN_PPB, ONE_IN_PPB + rate_error_ppb);

	spin_lock_irqsave(&tester_time, flags);
	now = ktime_get();
	if (!tester_began || restart) {
		tester_began = true;
		tester_position = 0;
		tester_fraction = 0;
		tester_due = ktime_add_ns(now, priv->period >> 32);
	}
	while (ktime_compare(tester_due, now) <= 0)
		tester_step(priv);
	spin_unlock_irqrestore(&tester_time, flags);

	WRITE_ONCE(priv->running, true);
	hrtimer_start(&priv->timer, tester_due, HRTIMER_MODE_ABS);
	return 0;
}

static int tester_cancel(struct comedi_device *dev, struct comedi_subdevice *s)
{
	struct tester_private *priv = dev->private;

	WRITE_ONCE(priv->running, false);
	hrtimer_cancel(&priv->timer);
	return 0;
}

static int tester_insn_read(struct comedi_device *dev, struct comedi_subdevice *s, struct comedi_insn *insn,
			    unsigned int *data)
{
	struct tester_private *priv = dev->private;
	unsigned int i;

	for (i = 0; i < insn->n; ++i)
		data[i] = tester_code(priv, tester_position);
	return insn->n;
}

static int tester_auto_attach(struct comedi_device *dev, unsigned long context)
{
	struct tester_private *priv;
	struct comedi_subdevice *s;
	int ret;

	dev->board_name = TESTER_NAME;
	priv = comedi_alloc_devpriv(dev, sizeof(*priv));
	if (!priv)
		return -ENOMEM;
	priv->dev = dev;
	hrtimer_init(&priv->timer, CLOCK_MONOTONIC, HRTIMER_MODE_ABS);
	priv->timer.function = tester_interrupt;
	ret = request_firmware(&priv->file, codes, tester_parent);
	if (ret)
		return ret;
	if (priv->file->size < 2 || priv->file->size % 2) {
		dev_err(dev->class_dev, "%s: not a file of 16-bit codes\n", codes);
		return -EINVAL;
	}

	ret = comedi_alloc_subdevices(dev, 1);
	if (ret)
		return ret;
	s = &dev->subdevices[0];
	s->type = COMEDI_SUBD_AI;
	s->subdev_flags = SDF_READABLE | SDF_GROUND | SDF_CMD_READ;
	s->n_chan = 1;
	s->len_chanlist = 1;
	s->maxdata = 0xFFFF;
	s->range_table = &tester_ranges;
	s->insn_read = tester_insn_read;
	s->do_cmdtest = tester_cmdtest;
	s->do_cmd = tester_cmd;
	s->cancel = tester_cancel;
	dev->read_subdev = s;
	return 0;
}

static void tester_detach(struct comedi_device *dev)
{
	struct tester_private *priv = dev->private;

	if (!priv)
		return;
	WRITE_ONCE(priv->running, false);
	if (priv->timer.function)
		hrtimer_cancel(&priv->timer);
	release_firmware(priv->file);
}

static struct comedi_driver tester_driver = {
	.driver_name = TESTER_NAME,
	.module = THIS_MODULE,
	.auto_attach = tester_auto_attach,
	.detach = tester_detach,
};

static int tester_plug_in(bool in)
{
	int ret = 0;

	mutex_lock(&tester_plug);
	if (in && !tester_is_attached) {
		ret = comedi_auto_config(tester_parent, &tester_driver, 0);
		tester_is_attached = ret == 0;
	} else if (!in && tester_is_attached) {
		/* What the PCI and USB drivers do when their board is pulled. */
		comedi_auto_unconfig(tester_parent);
		tester_is_attached = false;
	}
	mutex_unlock(&tester_plug);
	return ret;
}

static int attached_set(const char *value, const struct kernel_param *param)
{
	bool in;
	int ret = kstrtobool(value, &in);

	/* The parameters' own lock stays held: nobody else waits for it here. */
	return ret || !tester_parent ? ret : tester_plug_in(in);
}

static int attached_get(char *text, const struct kernel_param *param)
{
	return sysfs_emit(text, "%d\n", tester_is_attached);
}

static const struct kernel_param_ops attached_ops = { .set = attached_set, .get = attached_get };
module_param_cb(attached, &attached_ops, NULL, 0644);
module_param_named(overrun, tester_overrun, uint, 0644);
module_param_named(position, tester_position, ullong, 0444);

static ssize_t serial_show(struct device *dev, struct device_attribute *attr, char *text)
{
	return sysfs_emit(text, TESTER_SERIAL "\n");
}
static DEVICE_ATTR_RO(serial);

static int __init tester_init(void)
{
	int ret = comedi_driver_register(&tester_driver);

	if (ret)
		return ret;
	tester_place = platform_device_register_simple(TESTER_NAME, PLATFORM_DEVID_NONE, NULL, 0);
	if (IS_ERR(tester_place)) {
		comedi_driver_unregister(&tester_driver);
		return PTR_ERR(tester_place);
	}
	tester_parent = &tester_place->dev;
	ret = device_create_file(tester_parent, &dev_attr_serial);
	if (!ret)
		ret = tester_plug_in(true);
	if (ret) {
		platform_device_unregister(tester_place);
		comedi_driver_unregister(&tester_driver);
	}
	return ret;
}
module_init(tester_init);

static void __exit tester_exit(void)
{
	tester_plug_in(false);
	platform_device_unregister(tester_place);
	comedi_driver_unregister(&tester_driver);
}
module_exit(tester_exit);

MODULE_AUTHOR("stickslip");
MODULE_DESCRIPTION("Plays A/D codes as a friction tester's board would deliver them; for tests");
MODULE_LICENSE("GPL");
