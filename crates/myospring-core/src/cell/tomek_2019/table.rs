//! A table whose rows are the fields of a structure.

/// Defines a structure over a number type, and the rows that describe its fields, in order.
macro_rules! table {
    (
        $(#[$doc:meta])* $name:ident, $row:ty, $rows:ident;
        $($field:ident: $content:expr,)*
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub(super) struct $name<T> {
            $(pub(super) $field: T,)*
        }

        /// Descriptions of its fields, in order.
        pub(super) static $rows: [$row; <$name<()>>::LEN] = [$($content,)*];

        impl $name<()> {
            /// Number of fields.
            pub(super) const LEN: usize = [$(stringify!($field),)*].len();
        }

        #[allow(dead_code, reason = "each table needs a part")]
        impl<T: Copy> $name<T> {
            /// Takes its fields from consecutive numbers.
            #[inline(always)]
            pub(super) fn take(numbers: &mut impl FnMut() -> T) -> Self {
                Self { $($field: numbers(),)* }
            }

            /// Applies a function to each field.
            #[inline(always)]
            pub(super) fn map<U>(&self, of: impl Fn(T) -> U) -> $name<U> {
                $name { $($field: of(self.$field),)* }
            }

            /// Passes each field to a closure, in order.
            #[inline(always)]
            pub(super) fn give(&self, to: &mut impl FnMut(T)) {
                $(to(self.$field);)*
            }
        }
    };
}
pub(super) use table;
